// Tables of rotary axes in the loop: identified, written, applied by the simulated control to the exact
// machine of sim, which shares no physics with model/, and compared with what the program prints.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/identified_machines.h"
#include "tests/support/refusal.h"
#include "tests/support/rotary_machines.h"
#include "tests/support/table_samples.h"
#include "volcal/identify/compensation/checks/made_tables.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/sim/machine/control.h"
#include "volcal/studies/files/control_tables.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using testing::true_machine;

/// RMS over the poses that the program judges at: functional point, m, and direction of the tool's axis, rad.
RotaryLeft left_on(const sim::TruthMachine& truth, const Eigen::Vector3d& tool) {
  RotaryLeft left;
  const auto poses = poses_of_all_axes(truth.machine(), kRotaryCheckPoses);
  for (const AxisPosition& pose : poses) {
    sim::MachineState state;
    state.position = pose;
    const Eigen::Matrix4d actual = truth.pose(state, tool), nominal = truth.nominal_pose(state, tool);
    const double point = (actual - nominal).topRightCorner<3, 1>().norm();
    const Eigen::Vector3d a = actual.block<3, 1>(0, 2), n = nominal.block<3, 1>(0, 2);
    const double axis = std::atan2(a.cross(n).norm(), a.dot(n));
    left.rms += point * point / static_cast<double>(poses.size());
    left.axis_rms += axis * axis / static_cast<double>(poses.size());
    left.max = std::max(left.max, point);
  }
  left.rms = std::sqrt(left.rms);
  left.axis_rms = std::sqrt(left.axis_rms);
  return left;
}

struct LoopCase {
  const char* format;
  const char* type;
  const char* structure;
  std::map<std::string, std::string> settings = {};
};

TableFormatOptions loop_options(const LoopCase& tested) {
  const TableFormat& format = *find_table_format(tested.format);
  TableFormatOptions options;
  options.type = CompensationType::parse(tested.type);
  options.step = 0.3;
  options.grid_per_axis = 2;
  options.settings = testing::example_settings(format);
  for (const auto& [name, value] : tested.settings) options.settings[name] = value;
  return options;
}

class RotaryTablesInTheLoop : public ::testing::TestWithParam<LoopCase> {
 protected:
  static RotaryLeft applied(const FitResult& result, const std::vector<TableFile>& files) {
    sim::TruthMachine truth = true_machine(result);
    truth.set_correction(
        sim::command_correction({control_tables(*find_table_format(GetParam().format), files), 0.0, {}}));
    return left_on(truth, result.machine.tools.front().offset);
  }
};

/// Within 5 % or 0.05 um, 0.5 urad.
void expect_as_printed(double simulated, double printed, double least, const char* what) {
  EXPECT_NEAR(simulated, printed, std::max(0.05 * printed, least)) << what;
}

TEST_P(RotaryTablesInTheLoop, LeaveWhatIsPrinted) {
  const FitResult result = testing::rotary_result(GetParam().structure);
  const TableFormat& format = *find_table_format(GetParam().format);
  const MadeTables made = make_tables(format, result, loop_options(GetParam()));
  ASSERT_TRUE(made.rotary_check.has_value());
  const RotaryLeft before = left_on(true_machine(result), result.machine.tools.front().offset);
  expect_as_printed(before.rms, made.rotary_check->before.rms, 0.05e-6, "before");
  expect_as_printed(before.axis_rms, made.rotary_check->before.axis_rms, 0.5e-6, "axis before");
  EXPECT_GT(before.rms, 15e-6);
  const RotaryLeft after = applied(result, made.files);
  expect_as_printed(after.rms, made.rotary_check->exported.rms, 0.05e-6, "RMS");
  expect_as_printed(after.max, made.rotary_check->exported.max, 0.1e-6, "largest");
  expect_as_printed(after.axis_rms, made.rotary_check->exported.axis_rms, 0.5e-6, "axis");
  EXPECT_NEAR(after.rms, made.rotary_check->ideal.rms, 0.2e-6);
  const bool turns = std::string(GetParam().format) != "isg-csv";
  EXPECT_NEAR(after.axis_rms, (turns ? made.rotary_check->ideal : made.rotary_check->before).axis_rms,
              0.6e-6);
  if (loop_options(GetParam()).type.has(CompensationPart::RotaryLocation)) {
    EXPECT_LT(after.rms, 0.5 * before.rms);  // R-POS alone may leave more: errors of lines may cancel its own
  }
  RecordProperty("left", std::to_string(before.rms * 1e6) + " " + std::to_string(after.rms * 1e6));
  if (std::getenv("VOLCAL_SHOW_RESIDUALS") != nullptr)
    std::printf(
        "%-14s %-20s %-22s before %6.2f printed %7.3f simulated %7.3f um; axis %6.2f %6.2f %6.2f urad\n",
        GetParam().format, GetParam().type, GetParam().structure, before.rms * 1e6,
        made.rotary_check->exported.rms * 1e6, after.rms * 1e6, before.axis_rms * 1e6,
        made.rotary_check->exported.axis_rms * 1e6, after.axis_rms * 1e6);
}

/// The control's second reading and the format's own agree at every pose.
TEST_P(RotaryTablesInTheLoop, AreReadAlikeByTheSimulatedControl) {
  const FitResult result = testing::rotary_result(GetParam().structure);
  const TableFormat& format = *find_table_format(GetParam().format);
  const auto files = write_tables(format, result, loop_options(GetParam()));
  const CompensationTables own = format.read(files);
  const auto control = sim::command_correction({control_tables(format, files), 0.0, {}});
  const bool exact = std::string(GetParam().format) == "csv" || std::string(GetParam().format) == "isg-csv";
  double largest = 0.0;
  for (const AxisPosition& pose : poses_of_all_axes(result.machine, 100)) {
    for (const std::int8_t towards : {1, -1}) {
      sim::MachineState state;
      state.position = pose;
      state.direction.fill(towards);
      const sim::CommandMoves moves = control(state);
      const Correction correction = own.correction(pose, state.direction);
      // first order against exact transforms: 50 um x 50 urad x 0.5 m
      EXPECT_LT((moves.linear - correction.linear).norm(), exact ? 20e-9 : 1e-12);
      EXPECT_LT((moves.rotary - correction.rotary).norm(), 1e-12);
      largest = std::max(largest, moves.linear.norm() + 0.1 * moves.rotary.norm());
    }
  }
  EXPECT_GT(largest, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(
    All, RotaryTablesInTheLoop,
    ::testing::Values(
        LoopCase{"csv", "L-VOL+R-VOL", testing::kTrunnion}, LoopCase{"csv", "L-VOL+R-VOL", testing::kHead},
        LoopCase{"csv", "L-VOL+R-VOL", testing::kMixed}, LoopCase{"neutral-csv", "R-VOL", testing::kTrunnion},
        LoopCase{"neutral-csv", "R-VOL", testing::kHead},
        LoopCase{"neutral-csv", "L-VOL+R-VOL", testing::kMixed},
        LoopCase{"neutral-csv", "R-POS+R-POR", testing::kTrunnion},
        LoopCase{"linuxcnc-grid", "L-VOL+R-VOL", testing::kTrunnion},
        LoopCase{"linuxcnc-grid", "L-VOL+R-VOL", testing::kHead},
        LoopCase{"linuxcnc-grid", "R-VOL", testing::kMixed, {{"units", "inch"}}},
        LoopCase{"linuxcnc-grid", "R-POR", testing::kTrunnion},
        LoopCase{"isg-csv", "L-VOL+R-VOL", testing::kTrunnion},
        LoopCase{"isg-csv", "R-VOL", testing::kTrunnion, {{"workpiece_errors", "component"}}},
        LoopCase{"isg-csv", "R-VOL", testing::kHead},
        LoopCase{"isg-csv", "R-VOL", testing::kMixed, {{"workpiece_errors", "component"}}},
        LoopCase{"isg-csv", "R-POR", testing::kTrunnion},
        LoopCase{"sinumerik", "L-POS+R-POS", testing::kTrunnion},
        LoopCase{"sinumerik", "R-POS", testing::kHead}, LoopCase{"heidenhain", "R-POS", testing::kTrunnion},
        LoopCase{"heidenhain", "L-POS+R-POS", testing::kHead, {{"sign", "compensation"}}},
        LoopCase{"fanuc", "L-POS+R-POS", testing::kTrunnion, {{"detection_unit_deg", "0.0001"}}},
        LoopCase{"fanuc", "R-POS", testing::kHead, {{"sign", "error"}}}));

/// Linear axes that err by 4 and 7 um everywhere, home included, where their tables are zero: the table turns
/// the workpiece and not that error, which the tables of rotary axes take.
TEST(ErrorAtHome, DoesNotTurnWithTheTable) {
  testing::GivenErrors given;
  given.functions["EYX"] = [](double) { return 4e-6; };
  given.functions["EZY"] = [](double) { return -7e-6; };
  for (const char* name : {"csv", "neutral-csv", "linuxcnc-grid", "isg-csv"}) {
    for (const char* structure : {testing::kTrunnion, testing::kMixed}) {
      // Constants of ISG have no displacement of an axis along itself, here that of C in z.
      if (std::string(name) == "isg-csv" && structure != testing::kTrunnion) continue;
      given.locations = {{"EX0C", 5e-6}, {"EB0C", 20e-6}};
      given.locations[structure == testing::kTrunnion ? "EY0A" : "EX0B"] = 3e-6;
      const FitResult result = testing::result_with(testing::rotary_machine(structure), given, 36);
      const TableFormat& format = *find_table_format(name);
      const TableFormatOptions options = loop_options({name, "L-VOL+R-VOL", structure});
      sim::TruthMachine truth = true_machine(result);
      const RotaryLeft before = left_on(truth, result.machine.tools.front().offset);
      const MadeTables made = make_tables(format, result, options);
      truth.set_correction(sim::command_correction({control_tables(format, made.files), 0.0, {}}));
      const RotaryLeft after = left_on(truth, result.machine.tools.front().offset);
      EXPECT_GT(before.rms, 8e-6) << name << " " << structure;
      EXPECT_LT(after.max, 0.2e-6) << name << " " << structure;
      ASSERT_TRUE(made.all_axes.has_value());
      EXPECT_LT(made.all_axes->exported.max, 0.2e-6) << name << " " << structure;
      EXPECT_NEAR(made.rotary_check->exported.max, 0.0, 0.2e-6) << name << " " << structure;
    }
  }
}

/// Where the control computes with all errors, as in programs.
TEST(ErrorAtHome, IsCorrectedWhereTheTypeHasTheLinesOfTheTable) {
  testing::GivenErrors given;
  given.functions["EYX"] = [](double) { return 4e-6; };
  given.locations = {{"EX0C", 5e-6}, {"EY0A", 3e-6}};
  const FitResult result = testing::result_with(testing::rotary_machine(testing::kTrunnion), given, 36);
  const Tool& tool = result.machine.tools.front();
  const auto largest_left = [&](const char* type) {
    FiveAxisSettings settings;
    settings.type = CompensationType::parse(type);
    settings.tool_offset = tool.offset;
    const FiveAxisCompensation compensation(result.machine, settings, joint_errors(result, tool, {}));
    double largest = 0.0;
    for (const AxisPosition& pose : poses_of_all_axes(result.machine, 50)) {
      const auto left = compensation.left_by(compensation.correction(pose), pose);
      largest = std::max(largest, left.displacement_w.norm());
    }
    return largest;
  };
  EXPECT_LT(largest_left("L-VOL+R-VOL"), 1e-8);
  EXPECT_GT(largest_left("L-VOL"), 4e-6) << "zero at home, and nothing of the table";
}

/// More types never leave more, and the tool's axis turns under R-POS alone, where the control turns axes.
TEST(RotaryTablesOfMoreTypes, LeaveLess) {
  for (const char* name : {"neutral-csv", "linuxcnc-grid", "isg-csv"}) {
    const bool turns = std::string(name) != "isg-csv";
    for (const char* structure : {testing::kTrunnion, testing::kHead}) {
      const FitResult result = testing::rotary_result(structure);
      const TableFormat& format = *find_table_format(name);
      const RotaryLeft none = left_on(true_machine(result), result.machine.tools.front().offset);
      double before = none.rms;
      for (const char* type : {"R-POR", "R-POS+R-POR", "R-VOL"}) {
        sim::TruthMachine truth = true_machine(result);
        const auto files = write_tables(format, result, loop_options({name, type, structure}));
        truth.set_correction(sim::command_correction({control_tables(format, files), 0.0, {}}));
        const RotaryLeft left = left_on(truth, result.machine.tools.front().offset);
        EXPECT_LT(left.rms, before) << name << " " << structure << " " << type;
        before = left.rms;
        const bool turned = turns && CompensationType::parse(type).has(CompensationPart::RotaryPositioning);
        EXPECT_EQ(std::abs(left.axis_rms - none.axis_rms) > 0.5e-6, turned) << name << " " << type;
      }
      EXPECT_LT(before, 0.3e-6) << name << " " << structure;
    }
  }
}

/// A file with one mistake leaves the exact machine worse than the right one.
struct RotaryMistake {
  const char* what;
  const char* format;
  const char* type;
  const char* structure;
  const char* file;
  const char* from;  ///< every one of it
  const char* to;
  std::map<std::string, std::string> settings = {};
};

class MistakenRotaryFiles : public ::testing::TestWithParam<RotaryMistake> {};

TEST_P(MistakenRotaryFiles, ShowOnTheMachine) {
  const RotaryMistake& mistake = GetParam();
  const FitResult result = testing::rotary_result(mistake.structure);
  const TableFormat& format = *find_table_format(mistake.format);
  const LoopCase tested{mistake.format, mistake.type, mistake.structure, mistake.settings};
  std::vector<TableFile> files = write_tables(format, result, loop_options(tested));
  const auto left = [&] {
    sim::TruthMachine truth = true_machine(result);
    truth.set_correction(sim::command_correction({control_tables(format, files), 0.0, {}}));
    return left_on(truth, result.machine.tools.front().offset).rms;
  };
  const double right = left();
  for (TableFile& file : files) {
    if (file.name != mistake.file) continue;
    std::size_t at = file.content.find(mistake.from);
    ASSERT_NE(at, std::string::npos) << file.content.substr(0, 2000);
    const std::string from = mistake.from, to = mistake.to;
    for (; at != std::string::npos; at = file.content.find(from, at + to.size()))
      file.content.replace(at, from.size(), to);
  }
  try {
    EXPECT_GT(left(), right + 0.3e-6) << mistake.what;
  } catch (const InputError& error) {
    EXPECT_FALSE(error.remedy().empty());
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, MistakenRotaryFiles,
    ::testing::Values(
        RotaryMistake{"whose errors", "isg-csv", "R-VOL", testing::kTrunnion, "volcomp.csv",
                      "errors of the tool relative to the workpiece", "error motions of the axes themselves"},
        RotaryMistake{"chain", "isg-csv", "R-VOL", testing::kTrunnion, "volcomp.lis", "chain CA", "chain AC"},
        RotaryMistake{"side", "isg-csv", "R-VOL", testing::kTrunnion, "volcomp.lis", "workpiece_axes 2",
                      "workpiece_axes 1"},
        RotaryMistake{"location sign", "isg-csv", "R-VOL", testing::kHead, "volcomp.csv", "X0C", "Y0C"},
        RotaryMistake{"tool", "isg-csv", "R-VOL", testing::kHead, "volcomp.csv", "-200.000000", "200.000000"},
        RotaryMistake{"centre", "isg-csv", "R-VOL", testing::kTrunnion, "volcomp.csv", "PYA", "PXA"},
        RotaryMistake{"axis",
                      "linuxcnc-grid",
                      "R-VOL",
                      testing::kTrunnion,
                      "volcal.rotary",
                      "own A",
                      "own B",
                      {{"units", "mm"}}},
        RotaryMistake{"turn",
                      "linuxcnc-grid",
                      "R-VOL",
                      testing::kTrunnion,
                      "volcal.rotary",
                      "mm\nchain",
                      "inch\nchain",
                      {{"units", "mm"}}},
        RotaryMistake{"tool",
                      "linuxcnc-grid",
                      "R-VOL",
                      testing::kHead,
                      "volcal.rotary",
                      "tool 0.000000",
                      "tool 90.000000",
                      {{"units", "mm"}}},
        RotaryMistake{"centre",
                      "linuxcnc-grid",
                      "R-VOL",
                      testing::kHead,
                      "volcal.rotary",
                      "centre B 20.000000",
                      "centre B 90.000000",
                      {{"units", "mm"}}},
        RotaryMistake{"axis", "heidenhain", "R-POS", testing::kTrunnion, "CONFIG.CMA.txt", "A.COM C.COM",
                      "C.COM A.COM"},
        RotaryMistake{"sign", "heidenhain", "R-POS", testing::kTrunnion, "C.COM.txt", "ARE ERRORS",
                      "ARE COMPENSATIONS"},
        RotaryMistake{"shift", "fanuc", "R-POS", testing::kHead, "pitch_error.txt", "SHIFT B ", "SHIFT B 9"},
        RotaryMistake{"unit", "fanuc", "R-POS", testing::kHead, "pitch_error.txt", "UNIT_DEG 0.001",
                      "UNIT_DEG 0.01"},
        RotaryMistake{"sign", "fanuc", "R-POS", testing::kTrunnion, "pitch_error.txt", "VALUES COMPENSATIONS",
                      "VALUES ERRORS"},
        RotaryMistake{"sign", "sinumerik", "R-POS", testing::kTrunnion, "AX_EEC.INI", "]=-0.", "]=0."},
        RotaryMistake{"sign", "neutral-csv", "R-VOL", testing::kHead, "rotary_compensation_grid_tool.csv",
                      "# axes = B C", "# axes = A C"},
        RotaryMistake{"reference", "neutral-csv", "R-VOL", testing::kHead,
                      "rotary_compensation_grid_tool.csv", "mm = 20 0 -30", "mm = 20 0 30"}));

/// EXC = 10 um of a table and X0C = 10 um, in the words of ISO 230-1, mm; the table lies 10 um towards +x and
/// takes the workpiece there, the tool relative to it stands 10 um towards -x.
TEST(IsgRotaryBlocks, ByHand) {
  const Machine machine = testing::rotary_machine("w C' b X Y Z t");
  const FitResult result =
      testing::result_with(machine,
                           {.functions = {{"EXC", [](double q) { return 10e-6 * std::cos(q); }},
                                          {"ECC", [](double q) { return 20e-6 * std::sin(q); }}},
                            .locations = {{"EX0C", 12e-6}, {"EA0C", 30e-6}}},
                           36);
  TableFormatOptions options = loop_options({"isg-csv", "R-VOL", "", {}});
  options.rotary_step = 90.0 * kRadianPerDegree;
  const auto files = write_tables(*find_table_format("isg-csv"), result, options);
  EXPECT_EQ(find_file(files, "volcomp.lis")->content,
            "workpiece_axes 1\nchain CXYZ\nX 1\nY 2\nZ 3\nC 4\ninterpolation GRID\nfile[0] volcomp.csv\n"
            "file_format[0] ISG_CSV\n");
  const std::string& text = find_file(files, "volcomp.csv")->content;
  EXPECT_THAT(text, HasSubstr("P0X P0Y P0Z\n0.000000 0.000000 -200.000000\n#\n"));
  EXPECT_THAT(text, HasSubstr("PXC PYC PZC X0C Y0C A0C B0C C0C\n10.000000 -20.000000 0.000000 "
                              "0.012000000000 0.000000000000 0.000030000000 0.000000000000 "));
  EXPECT_THAT(text, HasSubstr("C EXC EYC EZC EAC EBC ECC\n0.000000 0.010000000000 "));
  EXPECT_THAT(text, HasSubstr("\n90.000000 0.000000000000 0.000000000000 0.000000000000 0.000000000000 "
                              "0.000000000000 0.000020000000\n180.000000 -0.010000000000 "));
  EXPECT_THAT(text, HasSubstr("\n360.000000 0.010000000000 "));
  options.settings["workpiece_errors"] = "component";
  const auto of_component = write_tables(*find_table_format("isg-csv"), result, options);
  EXPECT_THAT(find_file(of_component, "volcomp.csv")->content, HasSubstr("\n0.000000 -0.010000000000 "));
  EXPECT_THAT(find_file(of_component, "volcomp.csv")->content, HasSubstr("0.012000000000 0.000000000000"))
      << "location errors are those of the axis line on both sides";
}

/// Displacements of a linear axis on the workpiece side change their sign with the setting, and the control
/// takes them as what they are: EXX = 10 um at X = 100 mm.
TEST(IsgRotaryBlocks, LinearAxesOfTheWorkpieceSideFollowTheSetting) {
  const FitResult result = testing::result_with(
      testing::rotary_machine(testing::kHead),
      {.functions = {{"EXX", [](double q) { return 1e-4 * q; }}}, .locations = {{"EX0C", 5e-6}}}, 6);
  for (const char* type : {"L-VOL+R-VOL", "L-POS+R-VOL"}) {
    for (const char* meaning : {"relative", "component"}) {
      const auto files = write_tables(*find_table_format("isg-csv"), result,
                                      loop_options({"isg-csv", type, "", {{"workpiece_errors", meaning}}}));
      const bool relative = std::string(meaning) == "relative";
      EXPECT_THAT(find_file(files, "volcomp.csv")->content,
                  HasSubstr(relative ? "300.000000 0.030000000" : "300.000000 -0.030000000"))
          << type;
      const CompensationTables tables = find_table_format("isg-csv")->read(files);
      sim::MachineState state;
      state.position = {0.1, 0.0, 0.0, 0.0, 0.0, 0.0};
      const auto control =
          sim::command_correction({control_tables(*find_table_format("isg-csv"), files), 0.0, {}});
      EXPECT_NEAR(tables.correction(state.position, {}).linear.x(), -15e-6, 1e-9) << type << meaning;
      EXPECT_NEAR(control(state).linear.x(), -15e-6, 1e-9) << type << meaning;
    }
  }
}

/// Of a table at 90 degrees, 100 mm from its axis: ECC = 20 urad moves the tool 2 um towards -x of the
/// workpiece; the control has no axis to turn and moves X and Y along.
TEST(IsgRotaryBlocks, LinearAxesUndoTheAxisOwnRotation) {
  const Machine machine = testing::rotary_machine("w C' b X Y Z t");
  const FitResult result = testing::result_with(
      machine, {.functions = {{"ECC", [](double q) { return 20e-6 * std::sin(q); }}}}, 36);
  const auto files =
      write_tables(*find_table_format("isg-csv"), result, loop_options({"isg-csv", "R-VOL", "", {}}));
  const CompensationTables tables = find_table_format("isg-csv")->read(files);
  const AxisPosition pose = {0.11, -0.02, 0.0, 0.0, 0.0, 90.0 * kRadianPerDegree};
  const Correction correction = tables.correction(pose, {});
  // stator: arm (0.1, 0), own rotation 20 urad: displacement (0, 2 um) of the tool, so Y goes back by 2 um
  EXPECT_LT((correction.linear - Eigen::Vector3d(0.0, -2e-6, 0.0)).norm(), 1e-12);
  EXPECT_EQ(correction.rotary.norm(), 0.0);
}

/// The manual's second example: reference position 60 of a rotary axis, points of 45 degrees; the highest is
/// 68, the values from 61 to 68 add up to 0 and 60 has that of 68 (B-63980EN/01, page 100).
TEST(FanucRotaryTables, AreLaidOutLikeTheExampleOfTheManual) {
  const Machine machine = testing::rotary_machine("w C' b X Y Z t");
  // 0.010 deg at 90, -0.010 deg at 270: compensations of ECC = -0.010 deg sin C
  const FitResult result = testing::result_with(
      machine, {.functions = {{"ECC", [](double q) { return -0.010 * kRadianPerDegree * std::sin(q); }}}},
      36);
  TableFormatOptions options = loop_options({"fanuc", "R-POS", "", {{"first_number", "60"}}});
  options.rotary_step = 45.0 * kRadianPerDegree;
  const auto files = write_tables(*find_table_format("fanuc"), result, options);
  const std::string& text = files.at(0).content;
  EXPECT_THAT(text, HasSubstr("3620 C 60\n3621 C 60\n3622 C 68\n3623 C 1\n3624 C 45.0000\n3625 C 360.0000\n"
                              "SHIFT C 0.00000000\n"));
  EXPECT_THAT(text, HasSubstr("NUMBER VALUE\n60 7\n61 7\n62 3\n63 -3\n64 -7\n65 -7\n66 -3\n67 3\n68 7\n"));
  const CompensationTables tables = find_table_format("fanuc")->read(files);
  for (const double turns : {-1.0, 0.0, 2.0}) {
    const AxisPosition at = {0, 0, 0, 0, 0, (90.0 + 360.0 * turns) * kRadianPerDegree};
    EXPECT_NEAR(tables.correction(at, {}).rotary.z() / kRadianPerDegree, 0.010, 1e-9) << turns;
  }
  auto grown = files;
  const auto place = grown[0].content.find("\n68 7\n");
  grown[0].content.replace(place, 6, "\n68 6\n");
  EXPECT_THAT(testing::refusal([&] { find_table_format("fanuc")->read(grown); }),
              HasSubstr("do not add up to 0"));
}

TEST(HeidenhainRotaryTables, ByHand) {
  const Machine machine = testing::rotary_machine("w C' b X Y Z t");
  const FitResult result = testing::result_with(
      machine, {.functions = {{"ECC", [](double q) { return 0.010 * kRadianPerDegree * std::sin(q); }}}}, 36);
  TableFormatOptions options = loop_options({"heidenhain", "R-POS", "", {}});
  options.rotary_step = 90.0 * kRadianPerDegree;
  const auto files = write_tables(*find_table_format("heidenhain"), result, options);
  EXPECT_EQ(find_file(files, "C.COM.txt")->content,
            "; VOLCAL VALUES ARE ERRORS\nAXISPOS C\n0.0000 0.0000\n90.0000 0.0100\n180.0000 0.0000\n"
            "270.0000 -0.0100\n360.0000 0.0000\n");
  EXPECT_EQ(find_file(files, "CONFIG.CMA.txt")->content, "ACTIVE C\n* C.COM\n");
  options.settings["rows"] = "spacing";
  EXPECT_THAT(testing::refusal([&] { write_tables(*find_table_format("heidenhain"), result, options); }),
              HasSubstr("do not divide a turn evenly"));
}

/// ECC = a sin(12 C), 300 mm from the axis at most: straight lines between positions h apart are a (12 h)^2 /
/// 8 off, 0.8 um at 5 degrees and 0.13 um at 2.
TEST(RotarySteps, FollowTheTolerance) {
  const TableFormat& format = *find_table_format("neutral-csv");
  const auto made_with = [&](double waves, double tolerance, double rotary_step = 0.0) {
    const FitResult result = testing::result_with(
        testing::rotary_machine("w C' b X Y Z t"),
        {.functions = {{"ECC", [=](double q) { return 20e-6 * std::sin(waves * q); }}}}, 360);
    TableFormatOptions options = loop_options({"neutral-csv", "R-VOL", "", {}});
    options.rotary_step = rotary_step;
    return make_tables(format, result, options, tolerance);
  };
  const MadeTables fine = made_with(12.0, 0.0);
  EXPECT_NEAR(fine.options.rotary_step, 2.0 * kRadianPerDegree, 1e-12);
  EXPECT_LE(fine.rotary_check->deviation, kDefaultTableTolerance);
  EXPECT_THAT(fine.cautions, ::testing::IsEmpty());
  EXPECT_EQ(made_with(12.0, 2e-6).options.rotary_step, 0.0);
  EXPECT_EQ(made_with(1.0, 0.0).options.rotary_step, 0.0);
  const MadeTables given = made_with(12.0, 0.0, 10.0 * kRadianPerDegree);
  EXPECT_NEAR(given.options.rotary_step, 10.0 * kRadianPerDegree, 1e-12);
  ASSERT_EQ(given.cautions.size(), 1U);
  EXPECT_EQ(given.cautions[0].code, FindingCode::RotaryTablesOffIdeal);
}

/// The same of tables that have positions of their own, 10 degrees apart, unless a step or a tolerance is
/// given.
TEST(RotarySteps, RefineTablesWithPositionsOfTheirOwn) {
  const TableFormat& format = *find_table_format("csv");
  const FitResult result = testing::result_with(
      testing::rotary_machine("w C' b X Y Z t"),
      {.functions = {{"ECC", [](double q) { return 20e-6 * std::sin(12.0 * q); }}}}, 360);
  TableFormatOptions options = loop_options({"csv", "L-VOL+R-VOL", "", {}});
  const auto made_with = [&](double tolerance, double rotary_step) {
    options.rotary_step = rotary_step;
    return make_tables(format, result, options, tolerance);
  };
  EXPECT_GT(made_with(0.0, 0.0).rotary_check->deviation, 1e-6);
  EXPECT_LT(made_with(0.0, 2.0 * kRadianPerDegree).rotary_check->deviation, 0.14e-6);
  EXPECT_NEAR(made_with(0.2e-6, 0.0).options.rotary_step, 2.0 * kRadianPerDegree, 1e-12);
}

TEST(KinsRotaryFile, NeedsItsLinearAxesTogether) {
  const FitResult result = testing::rotary_result("w X' C' b Y Z t");
  EXPECT_THAT(testing::refusal([&] {
                write_tables(*find_table_format("linuxcnc-grid"), result,
                             loop_options({"linuxcnc-grid", "R-VOL", "", {}}));
              }),
              HasSubstr("without a rotary axis between them"));
}

}  // namespace
}  // namespace volcal
