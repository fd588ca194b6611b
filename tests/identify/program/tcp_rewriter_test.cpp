// Programs with tool centre point motion, rewritten and run on exact machines of sim, by a reading of the
// text and a control of the test's own.

#include "volcal/identify/program/tcp/tcp_rewriter.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/identified_machines.h"
#include "tests/support/refusal.h"
#include "tests/support/rotary_machines.h"
#include "tests/support/tcp_programs.h"
#include "volcal/identify/program/tcp/tcp_words.h"
#include "volcal/model/description/errors.h"
#include "volcal/sim/machine/truth_machine.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using testing::five_axis_result;
using ::testing::HasSubstr;
using testing::kTcpTool;
using testing::kWork;
using ::testing::Not;
using testing::tcp_rewritten;
using testing::TcpDone;

/// What a block of the text says: words that hold until they change; millimetres and degrees.
struct SaidPose {
  std::map<char, double> words;
  bool feed = false;
};

std::vector<SaidPose> said_poses(const std::string& text) {
  std::vector<SaidPose> poses;
  SaidPose now;
  bool active = false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('(')));
    bool moves = false;
    for (std::string word; words >> word;) {
      if (word == "G43.4") active = true;
      if (word == "G49") active = false;
      if (word == "G0") now.feed = false;
      if (word == "G1") now.feed = true;
      if (std::string("XYZABC").find(word[0]) == std::string::npos) continue;
      now.words[word[0]] = std::stod(word.substr(1));
      moves = active;
    }
    if (moves) poses.push_back(now);
  }
  return poses;
}

Vector3d said_point(const SaidPose& pose) {
  return kWork + 1e-3 * Vector3d(pose.words.at('X'), pose.words.at('Y'), pose.words.at('Z'));
}

/// The state in which the control holds the axes: Newton on the nominal chain of sim, by differences.
sim::MachineState controlled(const sim::TruthMachine& machine, const Vector3d& point,
                             const std::map<char, double>& words) {
  sim::MachineState state;
  for (const char letter : std::string("ABC")) {
    const auto found = words.find(letter);
    if (found != words.end())
      state.position[index_of(*axis_from_letter(letter))] = found->second * kRadianPerDegree;
  }
  const Vector3d at_zero = machine.nominal_point(state, kTcpTool);
  Eigen::Matrix3d ways;
  for (int k = 0; k < 3; ++k) {
    sim::MachineState moved = state;
    moved.position[static_cast<std::size_t>(k)] = 1.0;
    ways.col(k) = machine.nominal_point(moved, kTcpTool) - at_zero;
  }
  const Vector3d linear = ways.inverse() * (point - at_zero);
  for (int k = 0; k < 3; ++k) state.position[static_cast<std::size_t>(k)] = linear[k];
  return state;
}

struct RunErrors {
  double max = 0.0, rms = 0.0, axis_rms = 0.0, axis_max = 0.0;
};

/// Runs the written text on the exact machine; between its poses everything changes in proportion. What it
/// should have followed is the original's path at the same share of its length.
RunErrors run_on(const sim::TruthMachine& machine, const std::string& original, const std::string& written) {
  const std::vector<SaidPose> meant = said_poses(original), sent = said_poses(written);
  RunErrors errors;
  double weights = 0.0;  // by length of the path
  const auto judge = [&](const SaidPose& from, const SaidPose& to, double share) {
    SaidPose at = to;
    for (auto& [letter, value] : at.words)
      value = from.words.at(letter) + share * (value - from.words.at(letter));
    const sim::MachineState state = controlled(machine, said_point(at), at.words);
    const Vector3d actual = machine.point(state, kTcpTool);
    const Vector3d axis = machine.pose(state, kTcpTool).block<3, 1>(0, 2);
    // nearest of the original: the path is made of straight pieces in five coordinates
    double nearest = HUGE_VAL, angle = 0.0;
    for (std::size_t i = 1; i < meant.size(); ++i) {
      const Vector3d begin = said_point(meant[i - 1]), along = said_point(meant[i]) - begin;
      double t = along.squaredNorm() > 0.0 ? (actual - begin).dot(along) / along.squaredNorm() : 1.0;
      t = std::clamp(t, 0.0, 1.0);
      const double off = (begin + t * along - actual).norm();
      if (off >= nearest) continue;
      nearest = off;
      std::map<char, double> words;
      for (const auto& [letter, value] : meant[i].words)
        words[letter] = meant[i - 1].words.at(letter) + t * (value - meant[i - 1].words.at(letter));
      const sim::MachineState there = controlled(machine, begin + t * along, words);
      const Vector3d wanted = machine.nominal_pose(there, kTcpTool).block<3, 1>(0, 2);
      angle = std::atan2(axis.cross(wanted).norm(), axis.dot(wanted));
    }
    errors.max = std::max(errors.max, nearest);
    const double weight = (said_point(to) - said_point(from)).norm();
    errors.rms += weight * nearest * nearest;
    errors.axis_rms += weight * angle * angle;
    errors.axis_max = std::max(errors.axis_max, angle);
    weights += weight;
  };
  for (std::size_t i = 1; i < sent.size(); ++i) {
    if (!sent[i].feed) continue;
    for (const double share : {0.2, 0.5, 0.8, 1.0}) judge(sent[i - 1], sent[i], share);
  }
  errors.rms = std::sqrt(errors.rms / weights);
  errors.axis_rms = std::sqrt(errors.axis_rms / weights);
  return errors;
}

/// A swept surface: tilts and turns with the path, through the pole in the last block.
std::string tcp_program(const std::string& tilt) {
  return "%\nG21 G90 G54 (five axes)\nG0 " + tilt + "-10 C0\nG43.4 H1\nG0 X40 Y10 Z30 " + tilt +
         "-10 C0\nG1 X60 Y20 Z25 " + tilt + "-30 C40 F800\nX20 Y50 Z28 " + tilt + "-55 C120\nX-30 Y30 Z40 " +
         tilt + "-20 C200\nX-30 Y-20 Z35\nX0 Y0 Z30 " + tilt + "10 C200\nG49\nM30\n%\n";
}

class TcpPrograms : public ::testing::TestWithParam<const char*> {
 protected:
  FitResult result_ = five_axis_result(GetParam());
  std::string program_ = tcp_program(result_.machine.has_axis(AxisName::A) ? "A" : "B");
};

TEST_P(TcpPrograms, PutTheToolWhereTheProgramMeansIt) {
  const sim::TruthMachine machine = testing::true_machine(result_);
  TcpRewriteOptions options;
  options.decimals_mm = 5;
  const TcpDone done = tcp_rewritten(program_, result_, options);
  const RunErrors before = run_on(machine, program_, program_), after = run_on(machine, program_, done.text);
  EXPECT_GT(before.rms, 8e-6);
  EXPECT_LT(after.max, 0.6e-6) << done.text;
  EXPECT_LT(after.rms, 0.3e-6);
  // what is printed: distances to poses, not to the nearest place of the path
  EXPECT_GE(done.before.rms * 1.05, before.rms);
  EXPECT_LT(done.after.max, 0.7e-6);
  EXPECT_GT(done.after.rms, 0.0);
  EXPECT_GT(done.summary.split_lines, 3);
  EXPECT_EQ(done.summary.copied_rapids, 1);
  EXPECT_THAT(done.text, HasSubstr("%\nG21 G90 G54 (five axes)\n"));
  EXPECT_THAT(done.text, HasSubstr("\nG49\nM30\n%\n"));
}

TEST_P(TcpPrograms, TurnTheToolsAxisBackWithOrientation) {
  const sim::TruthMachine machine = testing::true_machine(result_);
  TcpRewriteOptions options;
  options.orientation = true;
  options.decimals_mm = 5;
  const TcpDone done = tcp_rewritten(program_, result_, options);
  const RunErrors before = run_on(machine, program_, program_), after = run_on(machine, program_, done.text);
  EXPECT_LT(after.max, 0.7e-6);
  EXPECT_LT(after.axis_rms, 0.4 * before.axis_rms);
  EXPECT_NEAR(done.after.axis_rms, after.axis_rms, 0.2 * after.axis_rms + 0.5e-6);
  // the last block goes through the pole: bounded, and said
  EXPECT_GT(done.summary.near_poles, 0);
  EXPECT_EQ(done.summary.first_near_pole, 10);
  EXPECT_LT(done.summary.largest_turn, 60.0 * done.before.axis_max);
  EXPECT_GT(done.summary.largest_turn, done.before.axis_max);
  EXPECT_LE(done.after.axis_max, 1.05 * done.before.axis_max);
}

INSTANTIATE_TEST_SUITE_P(Structures, TcpPrograms,
                         ::testing::Values(testing::kTrunnion, testing::kHead, testing::kMixed),
                         [](const auto& tested) {
                           return std::string(tested.param) == testing::kTrunnion ? "Trunnion"
                                  : std::string(tested.param) == testing::kHead   ? "Head"
                                                                                  : "Mixed";
                         });

/// C0C = 100 urad of a table and nothing else: C is sent 100 urad = 0.00573 deg less far. Its work
/// coordinates turn along by as much: the point, 110 and -10 mm from the axis, is written 1 um less in x and
/// 11 um in y.
TEST(TcpRewriter, TakesTheZeroPositionOfATableBack) {
  const FitResult result =
      testing::result_with(testing::rotary_machine("w C' b X Y Z t"), {.locations = {{"EC0C", 100e-6}}}, 4);
  const TcpDone done =
      tcp_rewritten("G21 G90 G54\nG0 C0\nG43.4 H1\nG0 X100 Y0 Z10 C0\nG1 C90 F100\n", result);
  EXPECT_EQ(done.text,
            "G21 G90 G54\nG0 C0\nG43.4 H1\nG0 X99.9990 Y-0.0110 Z10.0000 C-0.00573\nG1 C89.99427 F100\n");
}

/// X0C = 10 um: the table stands 10 um towards +x; at C = 0 X follows, at 90 degrees the table's own x points
/// towards -y of the machine ... in the turning work coordinates the point is asked for 10 um along the
/// machine's x: at C = 90 degrees (the table turned by -90) that is +y of the workpiece.
TEST(TcpRewriter, MovesTheProgrammedPointWithTheTablesLine) {
  const FitResult result =
      testing::result_with(testing::rotary_machine("w C' b X Y Z t"), {.locations = {{"EX0C", 10e-6}}}, 4);
  const TcpDone done = tcp_rewritten("G21 G90 G54\nG0 C0\nG43.4 H1\nG0 X50 Y0 Z10 C0\nG0 C90\n", result);
  EXPECT_EQ(done.text,
            "G21 G90 G54\nG0 C0\nG43.4 H1\nG0 X50.0100 Y0.0000 Z10.0000 C0.00000\nG0 X50.0000 Y0.0100 "
            "C90.00000\n");
}

TEST(TcpRewriter, RefusesWhatItCannotFollow) {
  const FitResult result = five_axis_result(testing::kTrunnion);
  const auto refused = [&](const std::string& program, TcpRewriteOptions options = {}) {
    return testing::refusal([&] { tcp_rewritten(program, result, std::move(options)); });
  };
  const std::string begin = "G21 G90 G54\nG0 A0 C0\nG43.4 H1\nG0 X0 Y0 Z0\n";
  EXPECT_EQ(refused(begin + "G1 X10 F100\nG49\n"), "");
  EXPECT_THAT(refused(begin + "G2 X10 Y0 I5 J0 F100\n"),
              HasSubstr("G2 is not followed in tool centre point"));
  EXPECT_THAT(refused(begin + "G91\n"), HasSubstr("G91 is not followed"));
  EXPECT_THAT(refused(begin + "G53 G0 Z0\n"), HasSubstr("G53 is not followed in"));
  EXPECT_THAT(refused(begin + "G1 X10 B5 F100\n"), HasSubstr("the machine has no axis B"));
  EXPECT_THAT(refused(begin + "G1 X400 F100\n"), HasSubstr("outside its travel"));
  EXPECT_THAT(refused(begin + "G1 A111 F100\n"), HasSubstr("takes A to"));
  EXPECT_THAT(refused(begin + "G1 X10 Y10 A-30 C90 F100 M0\n"), HasSubstr("in a block of its own"));
  EXPECT_THAT(refused("G21 G90 G54\nG1 X10 F100\nG43.4 H1\n"),
              HasSubstr("feed motion stands outside tool centre point motion"));
  EXPECT_THAT(refused("G21 G90 G54\nG43.4 H1\nG0 X0 Y0 Z0\n"), HasSubstr("the position of A is not known"));
  EXPECT_THAT(refused("G21 G90 G54\nG0 A0 C0\nG43.4 H1\nG1 X0 Y0 Z0 F100\n"),
              HasSubstr("begins before the positions"));
  EXPECT_THAT(refused("G21 G90 G54\nG0 A0 C0\nG43.4 H2\n"), HasSubstr("length of tool H2 is not given"));
  EXPECT_THAT(refused("G21 G90 G54\nG0 A0 C0\nG43.4\n"), HasSubstr("without H"));
  EXPECT_THAT(refused("G21 G90 G55\nG0 A0 C0\nG43.4 H1\nG0 X0 Y0 Z0\n"), HasSubstr("G55, whose offset"));
  EXPECT_THAT(refused("G90 G54\nG0 A0 C0\nG43.4 H1\nG0 X0 Y0 Z0\n"), HasSubstr("unit of length"));
  EXPECT_THAT(refused("TRAORI(2)\n"), HasSubstr("TRAORI(2) is not followed"));
  EXPECT_THAT(refused("(volcal compensate: result r)\nG43.4 H1\n"), HasSubstr("compensated already"));
  TcpRewriteOptions only_c;
  only_c.identified = {false, true, true};
  EXPECT_THAT(refused(begin + "G1 A-5 F100\n", only_c), HasSubstr("errors of axis A were not identified"));
  only_c.reference[0] = -5.0 * kRadianPerDegree;
  EXPECT_THAT(refused(begin, only_c), HasSubstr("it does not stand at -5 deg"));
  EXPECT_EQ(refused("G21 G90 G54\nG0 A-5 C0\nG43.4 H1\nG0 X0 Y0 Z0\nG1 X10 C30 F100\nG49\n", only_c), "");
  for (const char* program : {"G2 X1\n", "G91\n"})
    EXPECT_THAT(testing::refusal([&] { tcp_rewritten(begin + program, result); }), HasSubstr("part.ngc:5"));
}

/// C is measured from -180 to 180 degrees, all of a turn; A up to 20 degrees.
TEST(TcpRewriter, SaysWhatLiesBeyondTheReadings) {
  FitResult result = five_axis_result(testing::kTrunnion);
  const std::string begin = "G21 G90 G54\nG0 A0 C0\nG43.4 H1\nG0 X0 Y0 Z0\n";
  TcpRewriteOptions options;
  options.measured = MeasuredTravel(result);
  options.measured->ends[index_of(AxisName::A)] = {-20.0 * kRadianPerDegree, 20.0 * kRadianPerDegree};
  options.measured->ends[index_of(AxisName::C)] = {-180.0 * kRadianPerDegree, 180.0 * kRadianPerDegree};
  EXPECT_EQ(tcp_rewritten(begin + "G1 A10 C200 F100\n", result, options).summary.beyond_readings, 0);
  const TcpSummary beyond = tcp_rewritten(begin + "G1 A30 F100\n", result, options).summary;
  EXPECT_GT(beyond.beyond_readings, 0);
  EXPECT_EQ(beyond.first_beyond, 5);
  options.within_readings = true;
  EXPECT_THAT(testing::refusal([&] { tcp_rewritten(begin + "G1 A30 F100\n", result, options); }),
              HasSubstr("beyond the positions that were measured"));
}

/// C of a table goes round, that of a head stops at 180 degrees, whose travel is the same; the owner may say
/// otherwise of both.
TEST(TcpRewriter, ATableTurnsWithoutEndAndAHeadStops) {
  const auto with = [](const char* structure, std::optional<bool> endless) {
    FitResult result = five_axis_result(structure);
    for (Axis& axis : result.machine.axes) {
      if (axis.name == AxisName::C) axis.endless = endless;
    }
    return result;
  };
  const auto program = [](char tilt) {
    return fmt::format("G21 G90 G54\nG0 {}0 C170\nG43.4 H1\nG0 X0 Y0 Z0\nG1 C200 F100\n", tilt);
  };
  const auto refused = [&](const FitResult& result, char tilt) {
    return testing::refusal([&] { tcp_rewritten(program(tilt), result); });
  };
  const std::set<AxisName> c = {AxisName::C}, none;
  EXPECT_EQ(tcp_rewritten(program('A'), with(testing::kTrunnion, {})).summary.assumed_endless, c);
  EXPECT_EQ(tcp_rewritten(program('A'), with(testing::kTrunnion, true)).summary.assumed_endless, none);
  EXPECT_EQ(tcp_rewritten(program('B'), with(testing::kHead, true)).summary.assumed_endless, none);
  EXPECT_THAT(refused(with(testing::kHead, {}), 'B'),
              AllOf(HasSubstr("the block takes C to 1"), HasSubstr("outside its travel -180 to 180 deg"),
                    HasSubstr("C does not carry the workpiece"), HasSubstr("endless = true in [axes.C]")));
  EXPECT_THAT(refused(with(testing::kTrunnion, false), 'A'),
              AllOf(HasSubstr("outside its travel -180 to 180 deg"), Not(HasSubstr("endless"))));
}

TEST(TcpRewriter, FollowsTraoriAndInverseTime) {
  const FitResult result = five_axis_result(testing::kHead);
  const std::string begin = "G21 G90 G54\nG0 B0 C0\nN20 TRAORI\nG0 X40 Y10 Z30\n";
  const TcpDone traori = tcp_rewritten(begin + "G1 X60 Y20 B-30 C40 F800\nTRAFOOF\n", result);
  EXPECT_THAT(traori.text, HasSubstr("\nN20 TRAORI\n"));
  EXPECT_THAT(traori.text, HasSubstr("\nTRAFOOF\n"));
  const TcpDone timed = tcp_rewritten(begin + "G93\nG1 X60 Y20 B-30 C40 F2\nTRAFOOF\n", result);
  // shares of the time of the block: sum of 1/F is 1/2
  double time = 0.0;
  std::istringstream lines(timed.text.substr(timed.text.find("G93")));
  for (std::string line; std::getline(lines, line);) {
    const auto at = line.find('F');
    if (at != std::string::npos && line.find("TRA") == std::string::npos)
      time += 1.0 / std::stod(line.substr(at + 1));
  }
  EXPECT_NEAR(time, 0.5, 1e-4);
  EXPECT_EQ(tcp_begin("N10 G43.4 H1"), TcpBegin::ByCode);
  EXPECT_EQ(tcp_begin("traori ; five axes"), TcpBegin::ByName);
  EXPECT_EQ(tcp_begin("G43.1 (no G43.4)"), std::nullopt);
  EXPECT_EQ(tcp_begin("; TRAORI"), std::nullopt);
}

}  // namespace
}  // namespace volcal
