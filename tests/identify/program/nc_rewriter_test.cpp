// Rewritten programs, word for word: expected coordinates by hand, p' = p - e(p').

#include "volcal/identify/program/nc_rewriter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/nc_programs.h"
#include "tests/support/refusal.h"

namespace volcal {
namespace {

using testing::errors_with;
using testing::motions_of;
using testing::rewritten;
using testing::simple_setup;

/// The same error everywhere, um.
ProgramErrors shift(double x_um, double y_um, double z_um) {
  return errors_with([=](const AxisPosition&, const ApproachDirection&) {
    return Eigen::Vector3d(1e-6 * x_um, 1e-6 * y_um, 1e-6 * z_um);
  });
}

/// Scale of X: 100 um/m too long.
ProgramErrors long_x() {
  return errors_with(
      [](const AxisPosition& q, const ApproachDirection&) { return Eigen::Vector3d(1e-4 * q[0], 0, 0); });
}

TEST(NcRewriter, SubtractsTheErrorAtTheCommand) {
  // p' = p / (1 + 1e-4): 500 mm becomes 499.950005 mm, not 499.95 mm.
  NcRewriteOptions options;
  options.decimals_mm = 6;
  EXPECT_EQ(rewritten("G0 X500\n", long_x(), simple_setup(), options).text, "G0 X499.950005\n");
  // Errors that are straight along the path need no further line.
  EXPECT_EQ(rewritten("G1 X500 F100\n", long_x()).text, "G1 X499.9500 F100\n");
}

TEST(NcRewriter, RefusesDecimalsAndTolerancesOutOfRange) {
  const auto refused = [](const NcRewriteOptions& options) {
    return testing::refusal([&] { rewritten("G0 X10\n", shift(1, 0, 0), simple_setup(), options); });
  };
  for (const int decimals : {-3, 3, 8})
    EXPECT_THAT(refused({.decimals_mm = decimals}), ::testing::HasSubstr("give 4 to 7")) << decimals;
  for (const int decimals : {4, 7}) EXPECT_EQ(refused({.decimals_mm = decimals}), "");
  for (const double tolerance : {std::nan(""), -1e-6, 0.0}) {
    EXPECT_THAT(refused({.tolerance = tolerance}), ::testing::HasSubstr("--tolerance-um"));
    EXPECT_THAT(refused({.arc_tolerance = tolerance}), ::testing::HasSubstr("--arc-tolerance-um"));
  }
}

TEST(NcRewriter, AddsAxesThatTheBlockDoesNotMove) {
  EXPECT_EQ(rewritten("G0 X10 (over)\nG1 X20 F100 ; cut\n", shift(1, -2, 0.5)).text,
            "G0 X9.9990 Y0.0020 Z-0.0005 (over)\nG1 X19.9990 F100 ; cut\n");
  EXPECT_EQ(rewritten("n10g0x10y5z3\r\n", shift(0, -2, 0)).text, "n10g0x10 Y5.0020z3\r\n");
}

TEST(NcRewriter, CopiesWhatMovesNothing) {
  const std::string program =
      "%\n(part 7)\n\nN5 T1 M6 ; tool\nG21 G90\nG4 P0.5\nM3 S1000\nG64 P0.01\nM30\n%\nleft alone #\n";
  EXPECT_EQ(rewritten(program, shift(1, 2, 3)).text, program);
}

TEST(NcRewriter, LeavesAProgramAsItIsOnAPerfectMachine) {
  const std::string program = "G0 X1.5 Y-2\nG1 X3.25 F100\nG91 X.5 Z-1\nG90\nG53 G0 Z0\n";
  EXPECT_EQ(rewritten(program, shift(0, 0, 0)).text, program);
}

TEST(NcRewriter, WritesIncrementsThatDoNotAddUp) {
  // Steps of 0.1 mm on a scale of 1e-4: every increment is 0.09999 mm, written 0.1000 nine times out of ten.
  std::string program = "G91 F100\n";
  for (int i = 0; i < 5000; ++i) program += "G1 X0.1\n";
  const auto result = rewritten(program, long_x());
  NcInterpreter control(simple_setup(), "out.ngc");
  for (const std::string& line : testing::program_lines(result.text)) control.execute(line);
  EXPECT_NEAR(control.state().position.x(), 0.5 / 1.0001, 0.6e-7);
}

TEST(NcRewriter, WritesInchesAndOffsets) {
  NcSetup setup = simple_setup();
  setup.work_offsets[1] = Eigen::Vector3d(0.1, 0.0, -0.2);
  setup.tool_lengths[1] = 0.05;
  // 10 um are 0.00039 in.
  EXPECT_EQ(rewritten("G20 G0 X1\n", shift(10, 0, 0)).text, "G20 G0 X0.99961\n");
  EXPECT_EQ(rewritten("G55 G43 H1 G0 X1 Y0 Z2\n", shift(0, 0, 10), setup).text,
            "G55 G43 H1 G0 X1 Y0 Z1.9900\n");
  // G92 names the corrected position 5 as well, so that afterwards nothing is to be corrected.
  EXPECT_EQ(rewritten("G0 X10\nG92 X5\nG0 X6\n", shift(10, 0, 0)).text, "G0 X9.9900\nG92 X5\nG0 X6\n");
  EXPECT_EQ(rewritten("G55 G0 X1\nG53 G0 X0\nG0 X1\n", shift(10, 0, 0), setup).text,
            "G55 G0 X0.9900\nG53 G0 X-0.0100\nG0 X0.9900\n");
}

/// A lost motion of 10 um in X: +5 um towards +, -5 um towards -.
TEST(NcRewriter, TurnsRoundWithTheProgrammedMotion) {
  const ProgramErrors errors = errors_with(
      [](const AxisPosition&, const ApproachDirection& d) { return Eigen::Vector3d(5e-6 * d[0], 0, 0); });
  // Before the first motion no direction is known: nothing to correct. Then every turn of X has a line of its
  // own, to 5 um before its start towards + and behind it towards -; while Y moves, X keeps its direction.
  EXPECT_EQ(rewritten("G1 Y1 F100\nX10\nY2\nX0\n", errors).text,
            "G1 Y1 F100\nX-0.0050\nX9.9950\nY2\nX10.0050\nX0.0050\n");
  EXPECT_EQ(rewritten("G0 X10\nX5\n", errors).text, "G0 X9.9950\nX5.0050\n") << "rapids: end points";
}

TEST(NcRewriter, MakesChordsOfArcsAndKeepsTheModeRight) {
  NcRewriteOptions options;
  options.arc_tolerance = 1e-3;  // radius 10: chords of 52 degrees at most, two per quarter
  const auto result = rewritten("G2 X20 Y0 I10 F100\nX40 I10\nG0 X50\nG3 X40 R5\nG1 X0\n", shift(0, 0, 0),
                                simple_setup(), options);
  EXPECT_EQ(result.text,
            "G1 X2.9289 Y7.0711 F100\nX10.0000 Y10.0000\nX17.0711 Y7.0711\nX20.0000 Y0.0000\n"
            "X22.9289 Y7.0711\nX30.0000 Y10.0000\nX37.0711 Y7.0711\nX40.0000 Y0.0000\n"
            "G0 X50\n"
            "G1 X48.5355 Y3.5355\nX45.0000 Y5.0000\nX41.4645 Y3.5355\nX40.0000 Y0.0000\n"
            "G1 X0\n");
  EXPECT_EQ(result.summary.arcs, 3);
}

TEST(NcRewriter, ExpandsCyclesAndKeepsWordsInOrder) {
  EXPECT_EQ(
      rewritten("G98 G0 Z10\nN7 G82 X5 Y6 Z-3 R2 P0.5 F60 M8 (hole)\nX8\nG80\nG0 X0\n", shift(1, 0, 0)).text,
      "G98 G0 Z10 X-0.0010\n"
      "N7 G0 X4.9990 Y6.0000 F60 M8 (hole)\nZ2.0000\nG1 Z-3.0000\nG4 P0.5000\nG0 Z10.0000\n"
      "X7.9990\nZ2.0000\nG1 Z-3.0000\nG4 P0.5000\nG0 Z10.0000\n"
      "G80\nG0 X-0.0010\n");
}

/// Stops act after the motion, so that they go with its last line; others act before it.
TEST(NcRewriter, KeepsStopsBehindTheMotion) {
  NcRewriteOptions options;
  options.arc_tolerance = 1e-3;
  EXPECT_EQ(rewritten("G2 X10 Y10 I10 F100 M3 S9 M1\n", shift(0, 0, 0), simple_setup(), options).text,
            "G1 X2.9289 Y7.0711 F100 M3 S9\nX10.0000 Y10.0000 M1\n");
  EXPECT_EQ(rewritten("G2 X10 Y10 I10 F100 M30", shift(0, 0, 0), simple_setup(), options).text,
            "G1 X2.9289 Y7.0711 F100\nX10.0000 Y10.0000 M30");
}

TEST(NcRewriter, SharesTheTimeOfABlockUnderG93) {
  NcRewriteOptions options;
  options.arc_tolerance = 1e-3;
  const auto result = rewritten("G93 G2 X20 Y0 I10 F2\n", shift(0, 0, 0), simple_setup(), options);
  double time = 0.0;
  for (const NcMotion& motion : testing::motions_of(result.text)) time += motion.duration;
  EXPECT_NEAR(time, 30.0, 1e-4);
}

TEST(NcRewriter, WritesItsHeaderBelowThePercentSign) {
  NcRewriteOptions options;
  options.header = {"(volcal compensate: test)", "(conditions: none)"};
  EXPECT_EQ(rewritten("%\nG0 X1\n%\n", shift(0, 0, 0), simple_setup(), options).text,
            "%\n(volcal compensate: test)\n(conditions: none)\nG0 X1\n%\n");
  EXPECT_EQ(rewritten("G0 X1\r\n", shift(0, 0, 0), simple_setup(), options).text,
            "(volcal compensate: test)\r\n(conditions: none)\r\nG0 X1\r\n");
}

/// An axis is not commanded before the program commands it.
TEST(NcRewriter, MovesNoAxisWhosePositionIsUnknown) {
  NcSetup setup = simple_setup();
  setup.start.reset();
  EXPECT_EQ(rewritten("G0 X10 Y5\nZ3\n", shift(1, 1, 1), setup).text, "G0 X9.9990 Y4.9990\nZ2.9990\n");
}

/// The functional point follows the tool length: the angle EAZ-like error grows with it.
TEST(NcRewriter, TakesTheFunctionalPointFromTheLengthThatIsActive) {
  ProgramErrors errors = shift(0, 0, 0);
  errors.field = [](const Eigen::Vector3d& tool) {
    return [tool](const AxisPosition&, const ApproachDirection&) {
      return Eigen::Vector3d(-1e-4 * tool.z(), 0, 0);
    };
  };
  NcSetup setup = simple_setup();
  setup.tool_lengths = {{1, 0.1}, {2, 0.2}};
  FunctionalPoint point;
  point.without_length = Eigen::Vector3d(0, 0, -0.05);
  const std::string program = "G0 X10\nG43 H1\nG0 X10\nG43 H2 X10\nG49 X10\n";
  EXPECT_EQ(rewritten(program, errors, setup, {}, point).text,
            "G0 X9.9950\nG43 H1\nG0 X9.9900\nG43 H2 X9.9800\nG49 X9.9950\n");
  point.lengths_from = Eigen::Vector3d(0, 0, -0.3);
  EXPECT_THAT(rewritten(program, errors, setup, {}, point).text, ::testing::HasSubstr("G43 H2 X9.9500\n"));
}

/// Files that went through two systems end their lines in CR CR LF; what is copied keeps them.
TEST(NcRewriter, ReadsLinesThatEndInTwoCarriageReturns) {
  EXPECT_EQ(rewritten("G21 G90\r\r\nG0 X1 Y1 Z1\r\r\nM2\r\r\n", shift(0, 0, 0)).text,
            "G21 G90\r\r\nG0 X1 Y1 Z1\r\r\nM2\r\r\n");
}

/// A comment that fits its own block and no longer the block with corrected words.
TEST(NcRewriter, RefusesABlockThatGrowsBeyondWhatControlsRead) {
  const std::string program = "G0 X1 (" + std::string(245, 'c') + ")\n";
  EXPECT_THAT(testing::refusal([&] { rewritten(program, shift(1, 0, 0)); }),
              ::testing::AllOf(::testing::HasSubstr("part.ngc:1: the rewritten block has"),
                               ::testing::HasSubstr("write its comment on a line of its own")));
  EXPECT_EQ(rewritten(program, shift(0, 0, 0)).text, program);
}

}  // namespace
}  // namespace volcal
