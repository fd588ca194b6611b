// What is not followed is refused with file, line, problem and remedy, word for word.

#include <gtest/gtest.h>

#include "tests/support/nc_programs.h"

namespace volcal {
namespace {

using testing::motions_of;
using testing::refusal;
using testing::simple_setup;

struct Refused {
  std::string program;
  std::string message;
};

void expect_refused(const std::vector<Refused>& all, const NcSetup& setup = simple_setup()) {
  for (const Refused& each : all)
    EXPECT_EQ(refusal([&] { motions_of(each.program, setup); }), "part.ngc:" + each.message) << each.program;
}

TEST(NcRefusals, OfWordsThatCannotBeRead) {
  expect_refused({
      {"G1 X#1\n", "1: parameters (#) are not evaluated (write the numbers themselves)"},
      {"\n#3=1\n", "2: parameters (#) are not evaluated (write the numbers themselves)"},
      {"G1 X[1+2]\n", "1: expressions in [ ] are not evaluated (write the numbers themselves)"},
      {"O100 SUB\n",
       "1: O words (program numbers, subprograms) are not followed (write the program without subprograms, "
       "and "
       "take its number out)"},
      {"G0 X1 (open\n", "1: the comment is not closed (end it with ))"},
      {"G0 (a (b) c)\n", "1: a comment stands in a comment (comments cannot be nested)"},
      {"G0 X\n", "1: no number follows X (write a decimal number behind every letter)"},
      {"G0 Xinf\n", "1: no number follows X (write a decimal number behind every letter)"},
      {"G0 X1e9\n", "1: E belongs to no code of the block (take it out)"},
      {"G0 X9999999999\n", "1: the number behind X is too large (write a number below 1e9)"},
      {"G0 X1 N5\n", "1: N stands behind other words (write the number of a block first)"},
      {"G0 X1 2\n",
       "1: \"2\" begins no word (write words of a letter and a number, and comments in ( ) or after ;)"},
      {"G0 X1\rG0 X2\n",
       "1: a carriage return (CR) stands within the line (end the lines of the program with LF or CRLF)"},
      {"G0 X1 \xB5\n",
       "1: a character outside ASCII (byte 0xB5) stands outside a comment (write it in ASCII; comments may "
       "hold "
       "any character)"},
      {"G0 \x1b X1\n",
       "1: a control character (byte 0x1B) (remove it; write words of a letter and a number, and comments in "
       "( ) "
       "or after ;)"},
      {"G0 X1 X2\n", "1: X stands twice (write it once, or two blocks)"},
      {"G0 @3 ^20\n", "1: polar coordinates (@ and ^) are not read (write X, Y and Z coordinates)"},
  });
}

TEST(NcRefusals, OfCodesThatAreNotTracked) {
  expect_refused({
      {"G41 D1\n",
       "1: G41 (cutter compensation) is not followed (let the CAM system write the path of the tool's "
       "centre)"},
      {"G28\n",
       "1: G28 (moves to a stored position, which the program does not hold) is not followed (write G53 and "
       "the "
       "position)"},
      {"G38.2 Z1\n", "1: G38.2 (probing) is not followed (take it out; its result is not known beforehand)"},
      {"G33 Z1\n",
       "1: G33 (threads and rigid tapping) is not followed (take the block out; it must follow the spindle)"},
      {"G5 X1\n", "1: G5 (splines) is not followed (let the CAM system write lines and arcs)"},
      {"G68 R3\n",
       "1: G68 (rotated coordinates) is not followed (let the CAM system write the rotated path)"},
      {"G51 X1\n",
       "1: G51 (scaling and mirroring) is not followed (let the CAM system write the scaled path)"},
      {"G16\n", "1: G16 (polar coordinates) is not followed (write X, Y and Z coordinates)"},
      {"G84 Z1\n", "1: G84 (tapping) is not followed (take the cycle out; it must follow the spindle)"},
      {"G123\n", "1: G123 is unknown (write the codes of RS-274 that the guide lists, or take it out)"},
      {"M98 P1\n", "1: M98 is a subprogram, which is not followed (write the program without subprograms)"},
      {"M77\n", "1: M77 is unknown (take it out if it moves no axis)"},
      {"G0 A1\n",
       "1: A moves a rotary axis (only programs of X, Y and Z are compensated, and those with tool centre "
       "point motion (G43.4 H or TRAORI))"},
      {"G0 U1\n", "1: U moves a secondary axis or increments (write X, Y and Z with G90 or G91)"},
      {"G0 G1 X1\n", "1: G0 and G1 exclude each other (write them in two blocks)"},
      {"G10 L20 P1 X1\n",
       "1: of G10 only L2 without R is followed (set tools and other offsets on the control, and give them "
       "here)"},
      {"G10 L2 P1 R10\n",
       "1: of G10 only L2 without R is followed (set tools and other offsets on the control, and give them "
       "here)"},
  });
}

TEST(NcRefusals, OfWhatTheControlHoldsAndNobodyGave) {
  expect_refused({
      {"G55\nG0 X1\n",
       "2: the program moves in G55, whose offset is not given (add --work-offset G55=X...,Y...,Z... in mm)"},
      {"G43 H3\n", "1: the length of tool H3 is not given (add --tool-length H3=LENGTH in mm)"},
      {"G43\n",
       "1: G43 stands without H; controls differ in which tool's length they then take (write G43 H and the "
       "number of the tool)"},
      {"/G0 X1\n",
       "1: the block is skipped or run by the control's block-delete switch (say how it stands: "
       "--block-delete "
       "on (skip) or off (run))"},
      {"G10 L2 P2 X1\n",
       "1: G10 sets a part of G55, whose other axes are not given (add --work-offset G55=X...,Y...,Z... in "
       "mm)"},
      {"G92.3\n", "1: G92.3 restores what no G92 has stored (write G92 before it)"},
  });
  NcSetup unknown;
  unknown.work_offsets[0] = Eigen::Vector3d::Zero();
  expect_refused(
      {{"G0 X1\n",
        "1: the unit of length is not known here (write G21 or G20 before it, or give --units mm or "
        "inch)"},
       {"G21 G0 X1 Y1\nG1 X2 F100\n",
        "2: the feed motion begins before the position of Z is known (move every axis by G0 under G90 "
        "first, or give --start)"},
       {"G21 G91 G0 X1\n",
        "1: X moves by an increment before its position is known (move it under G90 first, or give "
        "--start)"},
       {"G21 G92 X1\n",
        "1: G92 X stands before the position of X is known (move the axis under G90 first, or give "
        "--start)"}},
      unknown);
}

TEST(NcRefusals, OfBlocksThatMeanNothingOrTwoThings) {
  expect_refused({
      {"X1\n", "1: coordinates stand without G0, G1, G2, G3 or a cycle (write the G code of the motion)"},
      {"G1 X1\n", "1: no feed is in force (write F after the unit and the feed mode are set)"},
      {"G1 X1 F100\nG20\nX2\n", "3: no feed is in force (write F after the unit and the feed mode are set)"},
      {"G93 G1 X1 F2\nX2\n",
       "2: the block has no F, which every feed motion under G93 needs (write F, one over minutes)"},
      {"G20 F10\n", "1: F stands in the block that changes the unit of length (write F in a block after it)"},
      {"F100 G2 X10\n", "1: the arc has neither R nor I J (write its radius or its centre)"},
      {"F100 G2 X10 I5 R5\n", "1: the arc has both R and a centre (write one of the two)"},
      {"F100 G2 X10 K5\n", "1: the arc has neither R nor I J (write its radius or its centre)"},
      {"F100 G2 X10 Y0 I4\n",
       "1: the arc's radius is 4.0000 mm at its start and 6.0000 mm at its end (correct its end point, its "
       "centre or its radius)"},
      {"F100 G2 X10 R4\n",
       "1: an arc of radius 4.0000 mm does not reach over 10.0000 mm (correct its end point, its centre or "
       "its "
       "radius)"},
      {"F100 G2 X0 R4\n",
       "1: an arc with R ends where it starts, which leaves its centre open (correct its end point, its "
       "centre or "
       "its radius)"},
      {"F100 G90.1 G2 X10 I5\n", "1: under G90.1 an arc needs both I and J (write both)"},
      {"F100 G2\n", "1: G2 has no coordinates (write where it goes)"},
      {"G4 P1 X2\n",
       "1: coordinates in the block of G4; controls differ in what they mean (write them in two blocks)"},
      {"G1 G92 X1\n", "1: a motion and an offset want the same coordinates (write them in two blocks)"},
      {"G21 G17 F100\nG0 X0 Y0 Z0\nG2 X10 I5\nG43.1 J1\n",
       "4: a motion and an offset want the same coordinates (write them in two blocks)"},
      {"G52 X1\nG92 X1\n",
       "2: G52 and G92 stand in one program; controls differ in whether they add up (use one of the two)"},
      {"G81 X1 Z-1 F10\n",
       "1: G81 has no R (write the depth and the R plane in the first block of the cycle)"},
      {"G0 Z5\nG81 X1 Z-1 R1 F10\n",
       "2: the cycle begins above R before G98 or G99 is written; controls differ in which they start with "
       "(write "
       "G98 (back to the height before the cycle) or G99 (to R))"},
      {"G98 G0 Z5\nG89 X1 Z-1 R1 F10\n",
       "2: G89 goes back above R; controls differ in where its feed ends (write G99 before it)"},
      {"G83 X1 Z-1 R1 F10\n", "1: G83 has no positive Q (write the depth of a peck as Q)"},
      {"G98 G83 X1 Z-1 R1 Q0.0000001 F10\n", "1: Q makes more than 10000 pecks (is it in the right unit?)"},
      {"G93 G81 X1 Z-1 R1 F10\n", "1: G81 stands under G93 (write cycles under G94)"},
      {"G53 F10\n", "1: G53 stands without a motion by G0 or G1 (write G53 G0 and the coordinates)"},
      {"G0 X1 R5\n", "1: R belongs to no code of the block (take it out)"},
      {"H1\n", "1: H belongs to no code of the block (take it out)"},
  });
}

TEST(NcRefusals, OfWhatLeavesTheIdentifiedTravelOrIsCompensatedAlready) {
  const ProgramErrors errors = testing::errors_with(
      [](const AxisPosition&, const ApproachDirection&) { return Eigen::Vector3d(0, 0, 1e-6); });
  const auto message = [&](const std::string& program) {
    return refusal([&] { testing::rewritten(program, errors); });
  };
  EXPECT_EQ(
      message("G0 X0\nG0 X1001\n"),
      "part.ngc:2: the end of the rapid is at X = 1001.0000 mm in machine coordinates, outside the "
      "identified travel -1000 to 1000 mm (check work offsets, tool lengths and units; errors are not known "
      "there)");
  EXPECT_EQ(message("G0 X999\nF100 G2 X999 Y2 J1\nG2 X999 Y-2 J-2 R2\n").substr(0, 10), "part.ngc:3");
  // Half a circle of radius 1 that swings over the end of the travel, though both its ends are inside.
  EXPECT_EQ(message("F100 G0 X-999.5\nG2 Y2 J1\n").substr(0, 36), "part.ngc:2: the path is at X = -1000");
  EXPECT_EQ(message("G0 Z-1000\n"), "") << "a rapid is held at the end of the travel";
  EXPECT_EQ(
      message("G1 Z-1000 F100\n"),
      "part.ngc:1: the corrected command is at Z = -1000.0010 mm in machine coordinates, outside the "
      "identified travel -1000 to 1000 mm (check work offsets, tool lengths and units; errors are not known "
      "there)");
  EXPECT_EQ(message("(volcal compensate: result r)\nG0 X1\n"),
            "part.ngc:1: the program has been compensated already (compensate the original program)");
}

/// Errors that grow faster than the path have no fixed point.
TEST(NcRefusals, OfErrorsThatChangeTooFast) {
  const ProgramErrors errors = testing::errors_with([](const AxisPosition& q, const ApproachDirection&) {
    return Eigen::Vector3d(1e-3 + 2.0 * q[0], 0, 0);
  });
  EXPECT_EQ(refusal([&] { testing::rewritten("G0 X1\n", errors); }),
            "part.ngc:1: the identified errors change too fast with position to be compensated (look at the "
            "result's error tables)");
}

}  // namespace
}  // namespace volcal
