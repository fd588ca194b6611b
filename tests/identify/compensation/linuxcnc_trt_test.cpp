// Pivots of LinuxCNC's xyzac-trt-kins and xyzbc-trt-kins: by hand, by the equations of the module written
// out, and on exact machines.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

#include "tests/support/identified_machines.h"
#include "tests/support/refusal.h"
#include "tests/support/rotary_machines.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/compensation/checks/made_tables.h"
#include "volcal/identify/compensation/checks/volume_check.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/sim/machine/control.h"
#include "volcal/sim/machine/truth_machine.h"
#include "volcal/studies/files/control_tables.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

constexpr const char* kTrtTrunnion = "w C' A' b X Y Z t";

/// C at (10, -20, 0) mm, displaced by 5 and 7 um against A; A at (0, 10, 50) mm, displaced by 10 and -20 um.
FitResult displaced_lines(const char* structure) {
  const bool by_a = std::string(structure) == kTrtTrunnion;
  testing::GivenErrors given;
  given.locations = {{"EX0C", 5e-6}, {"EY0C", 7e-6}};
  given.locations[by_a ? "EY0A" : "EX0B"] = 10e-6;
  given.locations[by_a ? "EZ0A" : "EZ0B"] = -20e-6;
  return testing::result_with(testing::rotary_machine(structure), given, 2);
}

TableFormatOptions pivots_alone() {
  TableFormatOptions options;
  options.type = CompensationPart::RotaryLocation;
  return options;
}

std::vector<TableFile> trt_files(const FitResult& result,
                                 const TableFormatOptions& options = pivots_alone()) {
  return write_tables(*find_table_format("linuxcnc-trt"), result, options);
}

/// Machine zero: C (10.005, -19.983, -0.020), A (y 10.010, z 49.980); the offset is what lies between.
TEST(LinuxCncTrt, PivotsByHand) {
  const std::vector<TableFile> files = trt_files(displaced_lines(kTrtTrunnion));
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].name, "pivots.hal");
  for (const char* line :
       {"setp xyzac-trt-kins.x-rot-point 10.005000\n", "setp xyzac-trt-kins.y-rot-point -19.983000\n",
        "setp xyzac-trt-kins.z-rot-point -0.020000\n", "setp xyzac-trt-kins.y-offset 29.993000\n",
        "setp xyzac-trt-kins.z-offset 50.000000\n", "# table moved 0.005000 0.017000 -0.020000\n",
        "# tool length 200.000000\n"})
    EXPECT_THAT(files[0].content, HasSubstr(line));
  // B at (20, 0, -30): x 20.010 less 10.015, z -30.020 less -0.020
  const std::string by_b = trt_files(displaced_lines("w C' B' b X Y Z t"))[0].content;
  for (const char* line :
       {"setp xyzbc-trt-kins.x-rot-point 10.015000\n", "setp xyzbc-trt-kins.y-rot-point -19.993000\n",
        "setp xyzbc-trt-kins.x-offset 9.995000\n", "setp xyzbc-trt-kins.z-offset -30.000000\n"})
    EXPECT_THAT(by_b, HasSubstr(line));
}

/// Joints of xyzac-trt-kins by the sines and cosines of trtfuncs.c, angles in its own sense.
Eigen::Vector3d joints_of_trtfuncs(const Eigen::Vector3d& point, const Eigen::Vector3d& rot, double dy,
                                   double dz, double a, double c) {
  const double x = point.x() - rot.x(), y = point.y() - rot.y(), z = point.z() - rot.z();
  return {std::cos(c) * x - std::sin(c) * y + rot.x(),
          std::sin(c) * std::cos(a) * x + std::cos(c) * std::cos(a) * y - std::sin(a) * z - std::cos(a) * dy +
              std::sin(a) * dz + dy + rot.y(),
          std::sin(c) * std::sin(a) * x + std::cos(c) * std::sin(a) * y + std::cos(a) * z - std::sin(a) * dy -
              std::cos(a) * dz + dz + rot.z()};
}

TEST(LinuxCncTrt, CorrectsByWhatTheModuleDoes) {
  const CompensationTables tables =
      find_table_format("linuxcnc-trt")->read(trt_files(displaced_lines(kTrtTrunnion)));
  const Eigen::Vector3d point(0.07, 0.03, 0.16);  // of the spindle's reference point over the table
  const double a = 0.6, c = -1.1, length = 0.2;
  const Eigen::Vector3d nominal =
      joints_of_trtfuncs(point, {0.010, -0.020, 0.0}, 0.030, 0.050 + length, a, c);
  const Eigen::Vector3d wanted =
      joints_of_trtfuncs(point + Eigen::Vector3d(5e-6, 17e-6, -20e-6), {0.010005, -0.019983, -0.00002},
                         0.029993, 0.050 + length, a, c);
  const AxisPosition commanded = {nominal.x(), nominal.y(), nominal.z(), -a, 0.0, -c};  // ISO 841
  EXPECT_LT((tables.correction(commanded, {}).linear - (wanted - nominal)).norm(), 1e-12);
  EXPECT_GT((wanted - nominal).norm(), 10e-6);
  EXPECT_EQ(tables.correction(commanded, {}).rotary.norm(), 0.0);
}

/// On exact machines whose lines are displaced nothing is left, for work that was touched off on the table.
TEST(LinuxCncTrt, LeavesNothingOfDisplacedLines) {
  for (const char* structure : {kTrtTrunnion, "w C' B' b X Y Z t", "w C' A' Y' b X Z t"}) {
    const bool by_a = std::string(structure).find('A') != std::string::npos;
    FitResult result = displaced_lines(by_a ? kTrtTrunnion : structure);
    result.machine.structure = Structure::parse(structure);
    const CompensationTables tables = find_table_format("linuxcnc-trt")->read(trt_files(result));
    sim::TruthMachine truth(result.machine);
    for (const ParameterBlock& block : result.layout.blocks) {
      if (block.location && is_rotary(block.location->axis))
        truth.set_location(*block.location, result.parameters[block.offset]);
    }
    double before = 0.0, after = 0.0;
    for (const AxisPosition& pose : poses_of_all_axes(result.machine, 60)) {
      sim::MachineState state;
      state.position = pose;
      const Eigen::Vector3d offset = result.machine.tools.front().offset;
      const Eigen::Vector3d nominal_w = truth.nominal_point(state, offset);
      before = std::max(before, (truth.point(state, offset) - nominal_w).norm());
      state.position = tables.correction(pose, {}).applied_to(pose);
      after = std::max(after, (truth.point(state, offset) - nominal_w).norm());
    }
    EXPECT_GT(before, 15e-6) << structure;
    EXPECT_LT(after, 2e-9) << structure;
  }
}

/// The simulated control by the sines and cosines of trtfuncs.c, the format's reader by rotations: the same
/// at every pose, with tables of the joints and without, in millimetres and inches.
TEST(LinuxCncTrt, TheSimulatedControlReadsThem) {
  const TableFormat& format = *find_table_format("linuxcnc-trt");
  for (const char* structure : {kTrtTrunnion, "w C' B' b X Y Z t"}) {
    for (const char* units : {"mm", "inch"}) {
      const FitResult result = displaced_lines(structure);
      TableFormatOptions options = pivots_alone();
      options.settings["units"] = units;
      const std::vector<TableFile> files = trt_files(result, options);
      const CompensationTables own = format.read(files);
      const auto control = sim::command_correction({control_tables(format, files), 0.0, {}});
      double largest = 0.0;
      for (const AxisPosition& pose : poses_of_all_axes(result.machine, 60)) {
        sim::MachineState state;
        state.position = pose;
        const sim::CommandMoves moves = control(state);
        EXPECT_LT((moves.linear - own.correction(pose, {}).linear).norm(), 1e-12) << structure;
        EXPECT_EQ(moves.rotary.norm(), 0.0);
        largest = std::max(largest, moves.linear.norm());
      }
      EXPECT_GT(largest, 15e-6) << structure;
    }
  }
}

/// With the screws' tables and alone a folder with pivots is one of linuxcnc-trt, and both parts act.
TEST(LinuxCncTrt, AFolderWithPivotsIsItsOwn) {
  testing::GivenErrors given;
  given.functions["EXX"] = [](double q) { return 1e-4 * q; };
  given.locations = {{"EX0C", 5e-6}};
  const FitResult result = testing::result_with(testing::rotary_machine(kTrtTrunnion), given, 2);
  TableFormatOptions options = pivots_alone();
  options.type = CompensationType(CompensationPart::Positioning) | CompensationPart::RotaryLocation;
  options.step = 0.1;
  AxisPosition pose{};
  pose[0] = 0.2;
  for (const bool alone : {false, true}) {
    const testing::ScratchFolder scratch;
    for (const TableFile& file : trt_files(result, alone ? pivots_alone() : options))
      std::ofstream(scratch.path() / file.name) << file.content;
    const TablesFolder folder = read_tables_folder(scratch.path().string());
    EXPECT_EQ(folder.format->name, "linuxcnc-trt");
    sim::MachineState state;
    state.position = pose;
    const Eigen::Vector3d moved =
        sim::command_correction({control_tables(*folder.format, folder.files), 0.0, {}})(state).linear;
    // the table stands 5 um further along X, and the screw 20 um too far
    EXPECT_NEAR(moved.x(), alone ? 5e-6 : -15e-6, 1e-8);
  }
}

/// What acts on rotary axes cannot be superimposed, which is said of pivots too.
TEST(LinuxCncTrt, PivotsAreNotSuperimposed) {
  const FitResult result = displaced_lines(kTrtTrunnion);
  TableFormatOptions options = pivots_alone();
  options.active = find_table_format("linuxcnc-trt")->read(trt_files(result));
  EXPECT_THAT(testing::refusal([&] { trt_files(result, options); }), HasSubstr("cannot be superimposed"));
}

/// Linear axes that err by 4 um along Y everywhere, where their tables are zero at home: the pivots hold it,
/// with the table turned as with it at 0.
TEST(LinuxCncTrt, PivotsHoldTheErrorAtHome) {
  testing::GivenErrors given;
  given.functions["EYX"] = [](double) { return 4e-6; };
  given.locations = {{"EX0C", 5e-6}, {"EY0A", 3e-6}};
  const FitResult result = testing::result_with(testing::rotary_machine(kTrtTrunnion), given, 2);
  given.functions.clear();
  const FitResult lines_alone = testing::result_with(testing::rotary_machine(kTrtTrunnion), given, 2);
  TableFormatOptions options = pivots_alone();
  options.type = CompensationType(CompensationPart::Positioning) | CompensationPart::RotaryLocation;
  options.step = 0.1;
  const TableFormat& format = *find_table_format("linuxcnc-trt");
  const CompensationTables with = format.read(trt_files(result, options)),
                           without = format.read(trt_files(lines_alone, options));
  for (const double c : {0.0, 1.0, 2.5}) {
    AxisPosition pose{};
    pose[index_of(AxisName::C)] = c;
    pose[index_of(AxisName::A)] = 0.4 * c;
    const Eigen::Vector3d more = with.correction(pose, {}).linear - without.correction(pose, {}).linear;
    EXPECT_LT((more - Eigen::Vector3d(0.0, -4e-6, 0.0)).norm(), 2e-9) << c;
  }
}

/// Tilts are left, and the check says how much that is.
TEST(LinuxCncTrt, WhatTiltsLeaveIsPrinted) {
  const FitResult result = testing::rotary_result(kTrtTrunnion);
  const MadeTables made = make_tables(*find_table_format("linuxcnc-trt"), result, pivots_alone());
  ASSERT_TRUE(made.rotary_check.has_value());
  std::printf("before %.2f, R-POR %.2f, pivots %.2f um\n", made.rotary_check->before.rms * 1e6,
              made.rotary_check->ideal.rms * 1e6, made.rotary_check->exported.rms * 1e6);
  EXPECT_LT(made.rotary_check->exported.rms, made.rotary_check->before.rms);
  EXPECT_GT(made.rotary_check->exported.rms, made.rotary_check->ideal.rms);
  const auto off = std::ranges::find(made.cautions, FindingCode::RotaryTablesOffIdeal, &Finding::code);
  ASSERT_NE(off, made.cautions.end());
  EXPECT_TRUE(off->flag("constants"));
}

/// Tables of linear axes need no finer step for what pivots cannot hold.
TEST(LinuxCncTrt, TiltsDoNotChooseTheStep) {
  TableFormatOptions options = pivots_alone();
  options.type = CompensationPart::Positioning | CompensationType(CompensationPart::RotaryLocation);
  const StepChoice step =
      choose_step(*find_table_format("linuxcnc-trt"), testing::rotary_result(kTrtTrunnion), options, 0.2e-6);
  EXPECT_TRUE(step.reached);
  EXPECT_LE(step.deviation, 0.2e-6);
}

TEST(LinuxCncTrt, RefusesOtherMachinesAndTools) {
  const auto message = [](const FitResult& result, const TableFormatOptions& options) {
    return testing::refusal([&] { trt_files(result, options); });
  };
  EXPECT_THAT(message(testing::rotary_result(testing::kHead), pivots_alone()), HasSubstr("is another"));
  EXPECT_THAT(message(testing::rotary_result("w C' b X Y Z t"), pivots_alone()), HasSubstr("is another"));
  FitResult lateral = displaced_lines(kTrtTrunnion);
  lateral.machine.tools.front().offset.x() = 0.06;
  EXPECT_THAT(message(lateral, pivots_alone()), HasSubstr("not along the spindle"));
}

TEST(LinuxCncTrt, DamagedFilesAreRefusedWithFileAndRemedy) {
  const TableFile whole = trt_files(displaced_lines(kTrtTrunnion))[0];
  const auto message = [&](const std::string& from, const std::string& to) {
    TableFile file = whole;
    const auto at = file.content.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    file.content.replace(at, from.size(), to);
    return testing::refusal([&] { find_table_format("linuxcnc-trt")->read(std::vector{file}); });
  };
  EXPECT_THAT(message("setp xyzac-trt-kins.y-offset 29.993000\n", ""), HasSubstr("a pin is missing"));
  EXPECT_THAT(message("xyzac-trt-kins.y-offset", "xyzac-trt-kins.x-offset"), HasSubstr("is not a pivot"));
  EXPECT_THAT(message("xyzac-trt-kins.y-offset", "xyzac-trt-kins.x-rot-point"), HasSubstr("set twice"));
  EXPECT_THAT(message("xyzac-trt-kins.y-offset", "xyzbc-trt-kins.y-offset"),
              HasSubstr("no pin of the module"));
  EXPECT_THAT(message("# tool length 200.000000\n", ""), HasSubstr("comment line is missing"));
  EXPECT_THAT(message("units mm", "units m"), HasSubstr("not known"));
  EXPECT_THAT(message("29.993000", "29,993"), HasSubstr("pivots.hal"));
  EXPECT_THAT(message("setp", "net"), HasSubstr("neither a comment nor setp"));
}

}  // namespace
}  // namespace volcal
