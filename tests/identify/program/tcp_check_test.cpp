// What is written of programs with tool centre point motion, and a check that reads it.

#include "volcal/identify/program/tcp/tcp_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/support/identified_machines.h"
#include "tests/support/nc_programs.h"
#include "tests/support/refusal.h"
#include "tests/support/rotary_machines.h"
#include "tests/support/tcp_programs.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using testing::five_axis_result;
using ::testing::HasSubstr;
using testing::kTcpTool;
using testing::kWork;
using testing::tcp_rewritten;
using testing::TcpDone;

/// What programs of X, Y and Z may not say, these may not either.
TEST(TcpTexts, RefusesWhatProgramsOfLinearAxesMayNotSay) {
  const FitResult result = five_axis_result(testing::kTrunnion);
  const std::string begin = "G21 G90 G54\nG0 A0 C0\nG43.4 H1\nG0 X0 Y0 Z0\n";
  const std::vector<std::pair<const char*, const char*>> refusals = {
      {"M98\n", "M98 is a subprogram, which is not followed"},
      {"M99\n", "M99 is a subprogram, which is not followed"},
      {"M98 P100\n", "M98 is a subprogram, which is not followed"},
      {"M240\n", "M240 is unknown"},
      {"M3.5\n", "M3.5 is unknown"},
      {"G1 X5\n", "no feed is in force"},
      {"G1 X5 F0\n", "no feed is in force"},
      {"G1 X5 F-10\n", "the feed is negative"},
      {"G1 X5 F10\nG94\nG93\nX6\n", "the block has no F"},
      {"G1 X5 F10\nG20\nX1\n", "no feed is in force"},
      {"G20 F10\n", "F stands in the block that changes the unit"},
      {"G0 G1 X5 F10\n", "G0 and G1 exclude each other"},
      {"G54 G55\n", "G54 and G55 exclude each other"},
      {"G80\nX5\n", "coordinates stand without G0, G1"},
      {"G80 X5\n", "coordinates in the block of G80"},
      {"G1 X5 F10 P3\n", "P belongs to no code of the block"},
      {"H2\n", "H belongs to no code of the block"},
      {"G1 X5 I2 F10\n", "I belongs to no code of the block"},
      {"G49\nG53\n", "G53 stands without a motion"},
      {"G1 X5 F10 D1\n", "D belongs to cutter compensation"},
  };
  for (const auto& [block, words] : refusals) {
    const std::string message = testing::refusal([&] { tcp_rewritten(begin + block, result); });
    EXPECT_THAT(message, AllOf(HasSubstr(words), HasSubstr("part.ngc:"))) << block;
  }
  const std::string comment(300, 'a');
  EXPECT_THAT(testing::refusal(
                  [&] { tcp_rewritten(begin + "G1 X5 F10 (" + comment.substr(0, 230) + ")\n", result); }),
              HasSubstr("characters, and controls read 255"));
}

/// Blocks with / are followed as the switch stands, and all lines of one keep it.
TEST(TcpTexts, FollowTheBlockDeleteSwitch) {
  const FitResult result = five_axis_result(testing::kTrunnion);
  const std::string begin = "G21 G90 G54\nG0 A0 C0\nG43.4 H1\nG0 X40 Y0 Z0\n";
  NcSetup setup = testing::tcp_setup();
  EXPECT_THAT(testing::refusal([&] { tcp_rewritten(begin + "/G1 C90 F100\n", result, {}, setup); }),
              HasSubstr("say how it stands: --block-delete"));
  setup.block_delete = true;
  const TcpDone skipped = tcp_rewritten(begin + "/G1 C90 F100\n", result, {}, setup);
  EXPECT_THAT(skipped.text, HasSubstr("\n/G1 C90 F100\n"));
  EXPECT_EQ(skipped.summary.motions, 1);
  setup.block_delete = false;
  const TcpDone run = tcp_rewritten(begin + "/G1 C90 F100\n", result, {}, setup);
  ASSERT_GT(run.groups.back().size(), 1U);
  for (const NcWrittenLine& line : run.groups.back()) EXPECT_EQ(line.text.front(), '/');
  EXPECT_LT(run.after.max, 0.7e-6);
}

/// X0C = 12 um, Y0A = 5 um and Z0A = 15 um, at A = C = 0 and wherever the point is: 12, 5 and 15 um more. The
/// words of both parts are the same, and mean places 200 mm apart.
TEST(TcpTexts, WritesTheWordsOfAnotherWorkOffset) {
  const FitResult result =
      testing::result_with(testing::rotary_machine(testing::kTrunnion),
                           {.locations = {{"EX0C", 12e-6}, {"EY0A", 5e-6}, {"EZ0A", 15e-6}}}, 4);
  NcSetup setup = testing::tcp_setup();
  setup.work_offsets[1] = kWork + Vector3d(0.1, 0.04, 0.0);
  const std::string part = "G0 X0 Y0 Z50\nG1 Z2 F500\nX20\n";
  const TcpDone done = tcp_rewritten("G21 G90 G54\nG0 A0 C0\nG43.4 H1\n" + part + "G0 Z50\nG0 X0\nG55\n" +
                                         part + "G54 G1 X0 Y0 Z50\nG20\nG0 X0 Y0 Z2\nG49\n",
                                     result, {}, setup);
  EXPECT_THAT(done.text, HasSubstr("\nG55\nG0 X0.0120 Y0.0050 Z50.0150\nG1 Z2.0150 F500\nX20.0120\n"));
  EXPECT_THAT(done.text, HasSubstr("\nG54 G1 X0.0120 Y0.0050 Z50.0150\n"));
  EXPECT_THAT(done.text, HasSubstr("\nG20\nG0 X0.00047 Y0.00020 Z2.00059\n"));
  EXPECT_LT(done.after.max, 0.3e-6);
  EXPECT_NEAR(done.length, 0.048 + 0.02 + 0.048 + 0.02 + Vector3d(0.12, 0.04, -0.048).norm(), 1e-9);
}

/// The figures of a check with one line of the text changed.
TcpErrors checked_with(const std::string& program, const FitResult& result, const TcpDone& done,
                       const std::string& from, const std::string& to) {
  TcpCheck check(result.machine, testing::tcp_errors(result), testing::tcp_setup(),
                 {kTcpTool, Vector3d::Zero()});
  const std::vector<std::string> lines = testing::program_lines(program);
  bool changed = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::vector<NcWrittenLine> written = done.groups[i];
    for (NcWrittenLine& line : written) {
      const std::size_t at = changed ? std::string::npos : line.text.find(from);
      if (at == std::string::npos) continue;
      line.text.replace(at, from.size(), to);
      changed = true;
    }
    check.add(lines[i], written);
  }
  EXPECT_TRUE(changed) << from << " in\n" << done.text;
  return check.after();
}

/// A micrometre too far, a word that is lost, a line that is lost, a turn that is lost: each stands in the
/// figures as the distance that it makes.
TEST(TcpCheck, SeesWhatIsWrittenWrongly) {
  const FitResult result = testing::result_with(testing::rotary_machine(testing::kTrunnion),
                                                {.locations = {{"EX0C", 12e-6}, {"EY0A", 5e-6}}}, 4);
  const std::string program =
      "G21 G90 G54\nG0 A0 C0\nG43.4 H1\nG0 X0 Y0 Z60\nX10 Y0 Z50\nG1 Z2 F500\nX20\nY30\nC90\nG49\n";
  const TcpDone done = tcp_rewritten(program, result);
  const auto changed = [&](const char* from, const char* to) {
    return checked_with(program, result, done, from, to);
  };
  EXPECT_LT(done.after.max, 0.4e-6) << done.text;
  EXPECT_LT(changed("X20.0120", "X20.0120").max, 0.4e-6);
  EXPECT_NEAR(changed("X20.0120", "X20.0220").max, 10e-6, 0.4e-6);
  EXPECT_NEAR(changed("X10.0120 ", "").max, 10e-3, 0.1e-3) << "the word of a rapid";
  EXPECT_NEAR(changed("Y30.0050", "").max, 30e-3, 0.1e-3) << "all of a line";
  EXPECT_NEAR(changed("X20.0120", "(X20.0120)").max, 10e-3, 0.1e-3);
}

/// A block that only turns moves nothing in the workpiece: its error counts by the way of a point 100 mm from
/// the axis. X0C = 10 um throughout.
TEST(TcpCheck, BlocksThatOnlyTurnCount) {
  const FitResult result =
      testing::result_with(testing::rotary_machine("w C' b X Y Z t"), {.locations = {{"EX0C", 10e-6}}}, 4);
  const TcpDone done =
      tcp_rewritten("G21 G90 G54\nG0 C0\nG43.4 H1\nG0 X50 Y0 Z10 C0\nG1 C720 F100\n", result);
  EXPECT_EQ(done.length, 0.0);
  EXPECT_NEAR(done.before.rms, 10e-6, 1e-9);
  EXPECT_NEAR(done.before.max, 10e-6, 1e-9);
  EXPECT_LT(done.after.max, 0.6e-6);
  EXPECT_GT(done.after.rms, 0.0);
}

/// The table turns a point 320 mm from its axis: X would have to follow beyond its travel between two ends
/// that are inside.
TEST(TcpTexts, RefusesPathsThatLeaveTheTravelBetweenTheirEnds) {
  const FitResult result =
      testing::result_with(testing::rotary_machine("w C' b X Y Z t"), {.locations = {{"EX0C", 1e-6}}}, 4);
  const std::string begin = "G21 G90 G54\nG0 C-60\nG43.4 H1\nG0 X285 Y10 Z0\n";
  EXPECT_EQ(testing::refusal([&] { tcp_rewritten(begin + "G0 C60\n", result); }), "");
  EXPECT_THAT(testing::refusal([&] { tcp_rewritten(begin + "G1 C60 F100\n", result); }),
              AllOf(HasSubstr("takes X to"), HasSubstr("part.ngc:5")));
}

}  // namespace
}  // namespace volcal
