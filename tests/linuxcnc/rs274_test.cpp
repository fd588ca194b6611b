// The interpreter of LinuxCNC, `rs274 -g`, as an independent witness: it must see the same motions and the
// same feed time in every program, as written by hand and as rewritten. Skipped where rs274 is not installed
// (Debian package linuxcnc-uspace). It prints canonical calls in program units and work coordinates with four
// decimals and rewrites its parameter file, so that it gets one of its own each time.

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>
#include <thread>
#include <utility>

#include "tests/support/identified_machines.h"
#include "tests/support/nc_programs.h"
#include "tests/support/scratch_folder.h"
#include "volcal/sim/machine/random_truth.h"
#include "volcal/sim/machine/reference_machines.h"

namespace volcal {
namespace {

struct NamedProgram {
  const char* name;
  const char* text;
};

// Axes stand at 0 at first; G54 to G59.3 are those of offsets(), tools 1 and 2 are 50 and 80 mm long.
constexpr std::array kPrograms = std::to_array<NamedProgram>({
    {"lines",
     "G21 G90\nF600\nG0 X10 Y-5 Z20\nG1 Z-1\nX35.5 Y12.25\nN10 x-4 y7 (cut) z2.5 ; end\nG0 Z50\nM2\n"},
    {"increments", "G21 G91\nF500\nG0 X10 Y10 Z10\nG1 X-3 Y2.5\nZ-4\nG90 G1 X0 Y0\nG91 X1\nX1\nX1\nM2\n"},
    {"arcs_xy",
     "G21 G90 G17\nF400\nG0 X0 Y0\nG2 X20 Y0 I10\nG3 X40 Y0 I10 J0\nG2 X40 Y0 I-7 J3\nG3 X60 Y20 R20\nG2 X80 "
     "Y0 R-25\nM2\n"},
    {"arcs_zx", "G21 G90 G18\nF400\nG0 X5 Y5 Z5\nG2 X25 Z5 I10\nG3 X25 Z45 K20 I0\nG2 X5 Z25 R20\nM2\n"},
    {"arcs_yz", "G21 G90 G19\nF400\nG0 X5 Y5 Z5\nG2 Y25 Z5 J10\nG3 Y25 Z45 K20\nG3 Y5 Z25 R20\nM2\n"},
    {"helices",
     "G21 G90\nF800\nG0 X30 Y0 Z10\nG2 X30 Y0 Z-5 I-30 J0\nG3 X-30 Y0 Z5 I-30 P2\nG18 G2 X-30 Z5 Y12 I8\nG19 "
     "G3 "
     "Y12 Z25 X-20 J0 K10\nM2\n"},
    {"absolute_centres", "G21 G90 G90.1\nF300\nG0 X10 Y0\nG2 X30 Y0 I20 J0\nG91.1\nG3 X50 Y0 I10 J0\nM2\n"},
    {"inches",
     "G20 G90\nF20\nG0 X1 Y0.5 Z0.25\nG1 X2.125\nG2 X3.125 Y1.5 I1 J0\nG21\nF500\nG1 X10 Y10 Z0\nM2\n"},
    {"offsets",
     "G21 G90\nF500\nG55 G0 X10 Y5 Z-10\nG1 X20\nG59.3 X30 Y5 Z-5\nG52 X5 Y1\nX0 Y0\nG52 X0 Y0\nG53 G0 X100 "
     "Y100 "
     "Z50\nG54 G1 X10 Y10 Z0\nG10 L2 P1 X7 Y8 Z9\nX10 Y10\nM2\n"},
    {"g92",
     "G21 G90\nF500\nG0 X20 Y10 Z5\nG92 X0 Y0\nG1 X5 Y5\nG92.2\nX5 Y5\nG92.3\nX0 Y0\nG92.1\nX1 Y1\nM2\n"},
    {"tool_lengths",
     "G21 G90\nF500\nG0 X10 Y10\nG43 H1 Z100\nG1 Z5\nX20\nG43 H2\nX25\nZ5\nG49\nX30\nG43.1 Z12.5\nX35 "
     "Z5\nM2\n"},
    {"inverse_time",
     "G21 G90\nF100\nG0 X0 Y0\nG93\nG1 X10 F20\nG2 X30 Y0 I10 F4\nG1 X10 Y8 F11.5\nG94\nF200\nX0\nM2\n"},
    {"drilling",
     "G21 G90 G98\nF200\nG0 X0 Y0 Z20\nG81 X10 Y10 Z-5 R2\nX20\nG99 G82 X30 Z-5 R2 P0.25\nX40\nG80\nG0 "
     "Z20\nG91 "
     "G81 X5 Z-12 R-10 L3\nG90 G80 G0 Z30\nM2\n"},
    {"pecking",
     "G21 G90 G98\nF200\nG0 X0 Y0 Z20\nG83 X10 Y10 Z-9.5 R2 Q3\nX15\nG73 X20 Z-7 R2 Q2\nG80\nG85 X25 Z-5 "
     "R2\nG99 G89 X30 "
     "Z-5 R2 P0.5\nG80\nM30\n"},
});

NcSetup offsets() {
  NcSetup setup = testing::simple_setup();
  for (std::size_t i = 1; i < kWorkOffsets; ++i) {
    const auto shift = static_cast<double>(i);
    setup.work_offsets[i] = Eigen::Vector3d(1e-2 * shift, -5e-3 * shift, 2e-3 * shift);
  }
  setup.tool_lengths = {{1, 0.05}, {2, 0.08}};
  return setup;
}

/// One call that moves or waits; lengths in mm, axis positions.
struct Move {
  char kind = 'R';  ///< R rapid, F feed, A arc, D dwell
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
};
struct MachineRun {
  std::vector<Move> moves;
  double feed_time = 0.0;  ///< s
};

/// Canonical calls as positions of the axes. State of the canonical machine: unit, offsets, feed, plane.
class CanonicalReader {
 public:
  void read(const std::string& line) {
    const auto open = line.find('(');
    if (open == std::string::npos) return;
    const auto space = line.rfind(' ', open);
    const std::string name = line.substr(space + 1, open - space - 1);
    const std::vector<double> v = numbers(line.substr(open + 1));
    if (name == "USE_LENGTH_UNITS") unit_ = line.find("INCHES") != std::string::npos ? 25.4 : 1.0;
    if (name == "SET_G5X_OFFSET") work_ = Eigen::Vector3d(v.at(1), v.at(2), v.at(3)) * unit_;
    if (name == "SET_G92_OFFSET") local_ = Eigen::Vector3d(v.at(0), v.at(1), v.at(2)) * unit_;
    if (name == "USE_TOOL_LENGTH_OFFSET") length_ = Eigen::Vector3d(v.at(0), v.at(1), v.at(2)) * unit_;
    if (name == "SET_FEED_RATE") feed_ = v.at(0) * unit_;
    if (name == "SELECT_PLANE") select_plane(line);
    if (name == "DWELL") {
      run_.moves.push_back({'D', at_});
      run_.feed_time += v.at(0);
    }
    if (name == "STRAIGHT_TRAVERSE") move('R', Eigen::Vector3d(v.at(0), v.at(1), v.at(2)) * unit_);
    if (name == "STRAIGHT_FEED") move('F', Eigen::Vector3d(v.at(0), v.at(1), v.at(2)) * unit_);
    if (name == "ARC_FEED") arc(v);
  }
  const MachineRun& run() const { return run_; }

 private:
  static std::vector<double> numbers(std::string text) {
    for (char& c : text) {
      if (c == ',' || c == ')') c = ' ';
    }
    std::istringstream stream(text);
    std::vector<double> all;
    for (double value = 0.0; stream >> value;) all.push_back(value);
    return all;
  }
  void select_plane(const std::string& line) {
    plane_ = line.find("PLANE_XY") != std::string::npos   ? std::array{0, 1, 2}
             : line.find("PLANE_XZ") != std::string::npos ? std::array{2, 0, 1}
                                                          : std::array{1, 2, 0};
  }
  void move(char kind, const Eigen::Vector3d& program) {
    const Eigen::Vector3d to = program + work_ + local_ + length_;
    if ((to - at_).norm() < 1e-9) return;
    if (kind == 'F') run_.feed_time += (to - at_).norm() / feed_ * 60.0;
    at_ = to;
    run_.moves.push_back({kind, to});
  }
  /// ARC_FEED(first end, second end, first centre, second centre, turns, end across the plane, ...)
  void arc(const std::vector<double>& v) {
    const Eigen::Vector3d origin = work_ + local_ + length_;
    Eigen::Vector3d to;
    to[plane_[0]] = v.at(0) * unit_ + origin[plane_[0]];
    to[plane_[1]] = v.at(1) * unit_ + origin[plane_[1]];
    to[plane_[2]] = v.at(5) * unit_ + origin[plane_[2]];
    const double cx = v.at(2) * unit_ + origin[plane_[0]], cy = v.at(3) * unit_ + origin[plane_[1]];
    const double from = std::atan2(at_[plane_[1]] - cy, at_[plane_[0]] - cx);
    double angle = std::atan2(to[plane_[1]] - cy, to[plane_[0]] - cx) - from;
    const double turns = v.at(4);
    if (turns > 0 && angle < 1e-9) angle += 2 * M_PI;
    if (turns < 0 && angle > -1e-9) angle -= 2 * M_PI;
    angle += 2 * M_PI * (turns > 0 ? turns - 1 : turns + 1);
    const double radius = std::hypot(at_[plane_[0]] - cx, at_[plane_[1]] - cy);
    run_.feed_time += std::hypot(radius * angle, to[plane_[2]] - at_[plane_[2]]) / feed_ * 60.0;
    at_ = to;
    run_.moves.push_back({'A', to});
  }

  double unit_ = 1.0;
  double feed_ = 0.0;
  std::array<int, 3> plane_ = {0, 1, 2};
  Eigen::Vector3d work_ = Eigen::Vector3d::Zero(), local_ = work_, length_ = work_, at_ = work_;
  MachineRun run_;
};

bool has_rs274() { return std::system("command -v rs274 >/dev/null 2>&1") == 0; }

constexpr double kInch = 25.4e-3;  // m; rs274 without an INI file has parameters and tools in inches

/// What a command prints, and its exit status.
std::pair<std::string, int> output_of(const std::string& command) {
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  return {text, ::pclose(pipe)};
}

/// rs274 shares memory with every other LinuxCNC of the computer and crashes when one begins or ends beside
/// it.
std::string calls_of_rs274(const std::string& command) {
  constexpr int kTries = 20;
  for (int i = 0; i < kTries; ++i) {
    const auto [text, status] = output_of(command);
    if (status == 0) return text;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  ADD_FAILURE() << "rs274 fails: " << command;
  return {};
}

/// Parameters of G54 ... G59.3, tool table, program; what rs274 makes of them.
MachineRun rs274_run(const std::string& program, const NcSetup& setup) {
  const testing::ScratchFolder scratch;
  const auto path = [&](const char* name) { return (scratch.path() / name).string(); };
  std::ofstream(path("part.ngc")) << program;
  std::ofstream tools(path("tool.tbl"));
  for (const auto& [number, length] : setup.tool_lengths)
    tools << std::setprecision(12) << "T" << number << " P" << number << " Z" << length / kInch << " D1\n";
  tools.close();
  std::ofstream parameters(path("scratch.var"));
  parameters << "5211 0\n5212 0\n5213 0\n5220 1\n";
  for (std::size_t i = 0; i < kWorkOffsets; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      parameters << std::setprecision(12) << 5221 + 20 * i + k << " "
                 << (*setup.work_offsets[i])[static_cast<Eigen::Index>(k)] / kInch << "\n";
  }
  parameters.close();
  const std::string command = "rs274 -g -v " + path("scratch.var") + " -t " + path("tool.tbl") + " " +
                              path("part.ngc") + " </dev/null 2>" + path("errors");
  CanonicalReader reader;
  std::istringstream calls(calls_of_rs274(command));
  for (std::string line; std::getline(calls, line);) reader.read(line);
  return reader.run();
}

/// The same by our interpreter; motions of no length left out.
MachineRun own_run(const std::string& program, const NcSetup& setup) {
  NcInterpreter interpreter(setup, "part.ngc");
  MachineRun run;
  for (const std::string& line : testing::program_lines(program)) {
    const NcStep& step = interpreter.execute(line);
    for (const NcMotion& motion : step.motions) {
      const bool dwell = motion.kind == NcMotionKind::Dwell, arc = motion.kind == NcMotionKind::Arc;
      if (motion.kind != NcMotionKind::Rapid) run.feed_time += motion.duration;
      if (!dwell && !arc && motion.length() < 1e-12) continue;
      const char kind = dwell ? 'D' : arc ? 'A' : motion.kind == NcMotionKind::Rapid ? 'R' : 'F';
      run.moves.push_back({kind, motion.to * 1e3});
    }
    if (step.commands.non_modal != 40) continue;
    run.moves.push_back({'D', interpreter.state().position * 1e3});
    run.feed_time += step.commands.value_or_zero('P');
  }
  return run;
}

std::string listed(const MachineRun& run) {
  std::ostringstream text;
  for (const Move& move : run.moves) text << move.kind << " " << move.to.transpose() << "\n";
  return text.str();
}

/// rs274 prints 4 decimals in program units: half of the last one, in inches 25.4 times that, of position and
/// of offset each.
void expect_same(const MachineRun& own, const MachineRun& theirs, double unit_mm) {
  ASSERT_EQ(own.moves.size(), theirs.moves.size()) << listed(own) << "---\n" << listed(theirs);
  for (std::size_t i = 0; i < own.moves.size(); ++i) {
    EXPECT_EQ(own.moves[i].kind, theirs.moves[i].kind) << "motion " << i;
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(own.moves[i].to[k], theirs.moves[i].to[k], 1.01e-4 * unit_mm)
          << "motion " << i << " axis " << k;
  }
  EXPECT_NEAR(own.feed_time, theirs.feed_time, 0.01 * theirs.feed_time);
}

class Rs274 : public ::testing::TestWithParam<NamedProgram> {
 protected:
  void SetUp() override {
    if (!has_rs274()) GTEST_SKIP() << "rs274 is not installed (Debian package linuxcnc-uspace)";
  }
  static std::string text() { return GetParam().text; }
  static double unit_mm() { return text().starts_with("G20") ? 25.4 : 1.0; }
};

TEST_P(Rs274, SeesTheSameMotions) {
  expect_same(own_run(text(), offsets()), rs274_run(text(), offsets()), unit_mm());
}

/// Corrected for a machine of sim: still what rs274 sees, in the time of the original within 1 %, and
/// somewhere else than the original.
TEST_P(Rs274, SeesTheSameMotionsWhenRewritten) {
  sim::RandomTruthOptions options;
  options.reversal_max = 4e-6;
  Machine machine = sim::machine_from_code("w X' b Y Z t", {{{-0.5, 0.5}, {-0.4, 0.4}, {-0.3, 0.3}}});
  const sim::TruthMachine truth = sim::random_truth(machine, 12, options);
  const FitResult result = testing::result_of(truth);
  FunctionalPoint point;
  point.without_length = machine.tools[0].offset;
  NcRewriteOptions coarse;
  coarse.arc_tolerance = 5e-6;
  const auto rewritten = testing::rewritten(text(), program_errors(result, {}, {}), offsets(), coarse, point);
  const MachineRun theirs = rs274_run(rewritten.text, offsets());
  expect_same(own_run(rewritten.text, offsets()), theirs, unit_mm());
  const MachineRun original = rs274_run(text(), offsets());
  EXPECT_NEAR(theirs.feed_time, original.feed_time, 0.01 * original.feed_time);
  EXPECT_GT((theirs.moves.back().to - original.moves.back().to).norm(), 1e-4) << "nothing was corrected";
}

INSTANTIATE_TEST_SUITE_P(Programs, Rs274, ::testing::ValuesIn(kPrograms),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace volcal
