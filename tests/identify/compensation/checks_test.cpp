// What tables leave: of all axes together, of linear axes beside rotary ones, and of errors that change
// within a lattice of places.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "tests/support/rotary_machines.h"
#include "tests/support/table_samples.h"
#include "volcal/identify/compensation/checks/made_tables.h"
#include "volcal/identify/compensation/five_axis_compensation.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/errors/volume/error_budget.h"
#include "volcal/identify/errors/volume/volumetric.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

MadeTables tables_of(const FitResult& result, const std::string& name, const CompensationType& type) {
  const TableFormat& format = *find_table_format(name);
  TableFormatOptions options;
  options.type = type;
  options.settings = testing::example_settings(format);
  return make_tables(format, result, options);
}

bool is_said(const MadeTables& made, FindingCode code) {
  return std::ranges::find(made.cautions, code, &Finding::code) != made.cautions.end();
}

/// A roll EAX(x) turns the tool vector t of a head about x by EAX: (0, -t_z, t_y) EAX. With the head at A it
/// is R(A) t; tables hold the error with t itself, so that EAX (0, -(R t - t)_z, (R t - t)_y) is left.
TEST(TablesOfAHead, LeaveTheLeverOfItsTilt) {
  Machine machine = testing::rotary_machine("w b X Y Z A t");
  const auto roll = [](double q) { return 40e-6 * q / 0.6; };  // zero at home, as tables have it
  const FitResult result = testing::result_with(machine, {.functions = {{"EAX", roll}}}, 6);
  const MadeTables made = tables_of(result, "neutral-csv", CompensationType::volumetric());
  const Eigen::Vector3d tool = machine.tools.front().offset, centre = machine.axis(AxisName::A).centre;
  std::vector<Eigen::Vector3d> places, errors;
  for (const AxisPosition& pose : poses_of_all_axes(machine, kAllAxesPoses)) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(pose[index_of(AxisName::A)], Eigen::Vector3d::UnitX()).toRotationMatrix();
    const Eigen::Vector3d tip = centre + turn * (tool - centre);
    places.push_back(Eigen::Vector3d(pose[0], pose[1], pose[2]) + tip);
    const Eigen::Vector3d moved = tip - tool;
    errors.push_back(roll(pose[0]) * Eigen::Vector3d(0.0, -moved.z(), moved.y()));
  }
  const VolumetricFigures expected = volumetric_figures(without_rigid_motion(places, errors));
  ASSERT_TRUE(made.all_axes.has_value());
  EXPECT_GT(expected.rms, 1e-6);
  EXPECT_NEAR(made.all_axes->levers.rms, expected.rms, 2e-3 * expected.rms);  // second order
  EXPECT_NEAR(made.all_axes->exported.rms, expected.rms, 0.02 * expected.rms);
  EXPECT_LT(made.check.exported.rms, 0.05e-6);
  EXPECT_TRUE(is_said(made, FindingCode::LeversOfTiltedHead));
}

/// Rotation of the best rigid motion by its six unknowns at once, rad.
Eigen::Vector3d rotation_of(const std::vector<Eigen::Vector3d>& places,
                            const std::vector<Eigen::Vector3d>& errors) {
  Eigen::MatrixXd rows(3 * places.size(), 6);
  Eigen::VectorXd values(3 * places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    rows.block<3, 3>(row, 0).setIdentity();
    for (int k = 0; k < 3; ++k)
      rows.block<3, 1>(row, 3 + k) = Eigen::Vector3d(Eigen::Vector3d::Unit(k).cross(places[i]));
    values.segment<3>(row) = errors[i];
  }
  return rows.colPivHouseholderQr().solve(values).tail<3>();
}

/// The roll turns the tool's axis R(A) e_z about x, across it: by EAX whatever A is. Tables of linear axes
/// leave all of that but what the rigid motion w that is best for the points turns: (EAX e_x - w) x R(A) e_z.
TEST(TablesOfAHead, LeaveTheDirectionOfTheToolsAxis) {
  const Machine machine = testing::rotary_machine("w b X Y Z A t");
  const auto roll = [](double q) { return 40e-6 * q / 0.6; };
  const FitResult result = testing::result_with(machine, {.functions = {{"EAX", roll}}}, 6);
  const MadeTables made = tables_of(result, "neutral-csv", CompensationType::volumetric());
  const Eigen::Vector3d tool = machine.tools.front().offset, centre = machine.axis(AxisName::A).centre;
  std::vector<Eigen::Vector3d> places, errors, axes, turns;
  for (const AxisPosition& pose : poses_of_all_axes(machine, kAllAxesPoses)) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(pose[index_of(AxisName::A)], Eigen::Vector3d::UnitX()).toRotationMatrix();
    const Eigen::Vector3d tip = centre + turn * (tool - centre);
    const Eigen::Vector3d moved = tip - tool;
    places.push_back(Eigen::Vector3d(pose[0], pose[1], pose[2]) + tip);
    errors.push_back(roll(pose[0]) * Eigen::Vector3d(0.0, -moved.z(), moved.y()));
    axes.push_back(turn.col(2));
    turns.push_back(roll(pose[0]) * Eigen::Vector3d::UnitX());
  }
  const Eigen::Vector3d frame = rotation_of(places, errors);
  double squares = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const double left = (turns[i] - frame).cross(axes[i]).norm();
    squares += left * left / static_cast<double>(axes.size());
    largest = std::max(largest, left);
  }
  ASSERT_TRUE(made.all_axes.has_value());
  EXPECT_GT(frame.norm(), 0.5e-6) << "the frame counts";
  EXPECT_NEAR(made.all_axes->levers.axis_rms, std::sqrt(squares), 2e-3 * std::sqrt(squares));
  EXPECT_NEAR(made.all_axes->levers.axis_max, largest, 2e-3 * largest);
  EXPECT_NEAR(made.all_axes->exported.axis_rms, std::sqrt(squares), 0.02 * std::sqrt(squares));
}

/// EA0Z leans Z, (0, -z, 0) EA0Z, and turns neither tool nor workpiece: of the direction of the tool's axis
/// nothing is wrong but in the frame that is best for the points.
TEST(TablesOfAHead, LeaveADirectionThatIsRightWhereAnAxisLeans) {
  const Machine machine = testing::rotary_machine("w b X Y Z A t");
  const FitResult result = testing::result_with(machine, {.locations = {{"EA0Z", 50e-6}}}, 6);
  const MadeTables made = tables_of(result, "neutral-csv", CompensationType::volumetric());
  const Eigen::Vector3d tool = machine.tools.front().offset, centre = machine.axis(AxisName::A).centre;
  std::vector<Eigen::Vector3d> places, errors, axes;
  for (const AxisPosition& pose : poses_of_all_axes(machine, kAllAxesPoses)) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(pose[index_of(AxisName::A)], Eigen::Vector3d::UnitX()).toRotationMatrix();
    places.push_back(Eigen::Vector3d(pose[0], pose[1], pose[2]) + centre + turn * (tool - centre));
    errors.push_back(-50e-6 * pose[2] * Eigen::Vector3d::UnitY());
    axes.push_back(turn.col(2));
  }
  const Eigen::Vector3d frame = rotation_of(places, errors);
  double squares = 0.0;
  for (const Eigen::Vector3d& axis : axes)
    squares += frame.cross(axis).squaredNorm() / static_cast<double>(axes.size());
  ASSERT_TRUE(made.all_axes.has_value());
  EXPECT_GT(frame.norm(), 5e-6);
  EXPECT_NEAR(made.all_axes->before.axis_rms, std::sqrt(squares), 2e-3 * std::sqrt(squares));
  EXPECT_LT(made.all_axes->exported.rms, 0.05e-6);
  EXPECT_LT(made.all_axes->exported.axis_rms, 0.1e-6);
}

/// The line of a table C is known to u = 40 um in x and y: in the axes of the workpiece that goes round with
/// C, so that sqrt(2) u is left, whatever motion of the workpiece is taken away. It was identified as 20 um.
TEST(TablesOfATable, SayHowBadlyTheErrorsAreKnown) {
  const Machine machine = testing::rotary_machine("w C' b X Y Z t");
  ModelSpec model;
  model.default_function.basis = "zero";
  FunctionSpec turn;
  turn.basis = "fourier";
  turn.degree = 1;
  turn.coefficients = {0.0, 0.0, 0.0};
  model.functions[*ErrorSymbol::parse("ECC")] = turn;
  model.locations[{Component::X, AxisName::C}] = 20e-6;
  model.locations[{Component::Y, AxisName::C}] = 0.0;
  FitResult result = stated_result(machine, model);
  const MadeTables stated = tables_of(result, "neutral-csv", CompensationType::parse("L-VOL+R-VOL"));
  EXPECT_EQ(stated.rotary_check->identification_u, 0.0);
  EXPECT_FALSE(is_said(stated, FindingCode::RotaryTablesMayWorsen));
  result.covariance.setZero(result.layout.size, result.layout.size);
  for (const ParameterBlock& block : result.layout.blocks) {
    if (block.location && is_rotary(block.location->axis) && !is_rotation(block.location->component))
      result.covariance(block.offset, block.offset) = 40e-6 * 40e-6;
  }
  const MadeTables made = tables_of(result, "neutral-csv", CompensationType::parse("L-VOL+R-VOL"));
  const double u = std::sqrt(2.0) * 40e-6;
  EXPECT_NEAR(made.rotary_check->identification_u, u, 0.03 * u);
  EXPECT_NEAR(made.rotary_check->expected_rms(), std::hypot(made.rotary_check->exported.rms, u), 0.03 * u);
  EXPECT_NEAR(made.all_axes->expected_rms(), std::hypot(made.all_axes->exported.rms, u), 0.03 * u);
  EXPECT_TRUE(is_said(made, FindingCode::RotaryTablesMayWorsen));
  const MadeTables turning = tables_of(result, "neutral-csv", CompensationType::parse("L-VOL+R-POS"));
  EXPECT_NEAR(turning.rotary_check->identification_u, u, 0.03 * u) << "of all their errors";
  EXPECT_FALSE(is_said(turning, FindingCode::RotaryTablesMayWorsen)) << "R-POS leaves what is uncertain";
}

/// Tables that were active are in what was identified, and are taken away with it: the lever is that of the
/// roll.
TEST(TablesOfAHead, LeaveTheSameLeverInPlaceOfOthers) {
  const auto roll = [](double q) { return 40e-6 * q / 0.6; };
  const FitResult result =
      testing::result_with(testing::rotary_machine("w b X Y Z A t"), {.functions = {{"EAX", roll}}}, 6);
  const TableFormat& format = *find_table_format("neutral-csv");
  TableFormatOptions options;
  options.type = CompensationType::volumetric();
  options.step = 0.05;
  const AllAxesCheck alone = *make_tables(format, result, options).all_axes;
  options.active.emplace();
  options.active->terms.push_back(axis_term(
      AxisName::X,
      {.input = AxisName::X, .position = {-0.3, 0.3}, .forward = {-6e-6, 6e-6}, .backward = {-6e-6, 6e-6}}));
  const AllAxesCheck beside = *make_tables(format, result, options).all_axes;
  EXPECT_NEAR(beside.levers.rms, alone.levers.rms, 1e-12);
  EXPECT_NEAR(beside.before.rms, alone.before.rms, 1e-12) << "the machine as it was measured";
  EXPECT_NEAR(beside.exported.rms, alone.exported.rms, 0.01e-6);
}

TEST(TablesOfATable, HaveNoLeverThatTurns) {
  const auto roll = [](double q) { return 40e-6 * q / 0.6; };  // zero at home, as tables have it
  const FitResult result =
      testing::result_with(testing::rotary_machine("w A' b X Y Z t"), {.functions = {{"EAX", roll}}}, 6);
  const MadeTables made = tables_of(result, "neutral-csv", CompensationType::volumetric());
  ASSERT_TRUE(made.all_axes.has_value());
  EXPECT_LT(made.all_axes->levers.rms, 0.01e-6);
  EXPECT_LT(made.all_axes->exported.rms, 0.05e-6);
  EXPECT_FALSE(is_said(made, FindingCode::LeversOfTiltedHead));
  EXPECT_TRUE(is_said(made, FindingCode::RotaryErrorsUnknownToTables)) << "nothing of A was identified";
}

/// Errors of 4 um in y and 7 um in z everywhere, home included. Along the line of a single table C nothing
/// turns, which leaves the 4 um across it; of a table on a table sqrt(4^2 + 7^2) um. Half a turn of C shows
/// twice the 4 um to the workpiece.
TEST(TablesOfATable, SayWhatTheyLeaveOfTheErrorAtHome) {
  testing::GivenErrors given;
  given.functions["EYX"] = [](double) { return 4e-6; };
  given.functions["EZY"] = [](double) { return -7e-6; };
  given.locations = {{"EX0C", 5e-6}};
  const auto of_type = [&](const char* structure, const char* type) {
    const FitResult result = testing::result_with(testing::rotary_machine(structure), given, 4);
    return tables_of(result, "neutral-csv", CompensationType::parse(type));
  };
  const auto said = [](const MadeTables& made) {
    const auto found = std::ranges::find(made.cautions, FindingCode::ErrorAtHomeTurns, &Finding::code);
    return found == made.cautions.end() ? 0.0 : found->number("error").si;
  };
  EXPECT_NEAR(said(of_type("w C' b X Y Z t", "L-VOL")), 4e-6, 1e-11);
  EXPECT_NEAR(said(of_type("w C' b X Y Z t", "L-VOL+R-POS")), 4e-6, 1e-11);
  EXPECT_EQ(said(of_type("w C' b X Y Z t", "L-VOL+R-VOL")), 0.0);
  EXPECT_EQ(said(of_type("w C' b X Y Z t", "R-POS")), 0.0) << "no tables of linear axes";
  EXPECT_EQ(said(of_type("w b X Y Z C t", "L-VOL")), 0.0) << "C turns no workpiece";
  given.locations["EY0A"] = 3e-6;
  EXPECT_NEAR(said(of_type(testing::kTrunnion, "L-VOL")), std::sqrt(65.0) * 1e-6, 1e-11);
  const FitResult result = testing::result_with(
      testing::rotary_machine("w C' b X Y Z t"),
      {.functions = {{"EYX", given.functions["EYX"]}}, .locations = {{"EX0C", 1e-12}}}, 4);
  const MadeTables made = tables_of(result, "csv", CompensationType::volumetric());
  FiveAxisSettings settings;
  settings.tool_offset = result.machine.tools.front().offset;
  const FiveAxisCompensation machine(result.machine, settings,
                                     joint_errors(result, result.machine.tools.front(), {}));
  const auto left_at = [&](double turn) {
    AxisPosition pose{};
    pose[index_of(AxisName::C)] = turn;
    return machine.left_by(made.read_back.correction(pose, {}), pose, {}).displacement_w;
  };
  EXPECT_NEAR((left_at(std::numbers::pi) - left_at(0.0)).norm(), 8e-6, 1e-9);
}

/// Errors of rotary axes alone: what tables add for them with the axes at 0 is no error of the linear axes,
/// where one of these stands on the table too.
TEST(TablesOfRotaryAxes, LeaveLinearAxesAlone) {
  for (const char* structure : {"w C' A' Y' b X Z t", "w Y' C' A' b X Z t", testing::kMixed}) {
    const FitResult result = testing::rotary_result(structure);
    const MadeTables made = tables_of(result, "neutral-csv",
                                      CompensationType::volumetric() | CompensationType::rotary_volumetric());
    EXPECT_LT(made.check.before.rms, 1e-9) << structure;
    EXPECT_LT(made.check.exported.max, 0.3e-6) << structure;
    EXPECT_LT(made.step.deviation, 0.3e-6) << structure;
    EXPECT_TRUE(made.step.reached) << structure;
  }
}

FitResult stated(const EffectSpec& effect) {
  Machine machine = testing_support::machine_of("wX'bYZt");
  machine.tools = {{"short", {0.0, 0.0, -0.1}, 0.0}};
  ModelSpec model;
  model.default_function.basis = "zero";
  model.effects = {effect};
  return stated_result(machine, model);
}

/// A lead error of 5 um along 1 m of X, periods in a proportion to the travel that a lattice has too: its
/// root mean square is 5 / sqrt 2 um.
TEST(ErrorLeft, SeesWavesOfAnyPeriod) {
  for (const double period : {1.0 / 7.0, 1.0 / 9.0, 0.02, 0.01}) {
    const FitResult result = stated(effect_spec(
        "lead-error", {{"symbol", std::string("EYX")}, {"period", period}, {"cos", 5e-6}, {"sin", 0.0}}));
    const DisplacementField errors = displacement_field(result, result.machine.tools.front(), {});
    const ErrorLeft left = error_left(result.machine, volume_points(result.machine, kVolumeCells), errors);
    EXPECT_NEAR(left.rms, 5e-6 / std::numbers::sqrt2, 0.2e-6) << period;
    EXPECT_GT(left.max, 4.8e-6) << period;
  }
}

/// One volume, whoever judges it.
TEST(ErrorLeft, IsBeforeTablesWhatTheBudgetSays) {
  for (const EffectSpec& effect :
       {effect_spec("lead-error",
                    {{"symbol", std::string("EYX")}, {"period", 0.3}, {"cos", 5e-6}, {"sin", 0.0}}),
        effect_spec("reversal", {{"symbol", std::string("EXX")}, {"amplitude", 6e-6}})}) {
    const FitResult result = stated(effect);
    const Tool& tool = result.machine.tools.front();
    const BudgetLine whole = error_budget(result, tool, default_conditions(result), kVolumeCells).total;
    const ErrorLeft before = tables_of(result, "csv", CompensationType::volumetric()).check.before;
    EXPECT_GT(before.rms, 1e-6) << effect.kind;
    EXPECT_NEAR(before.rms, whole.rms, 1e-12) << effect.kind;
    EXPECT_NEAR(before.max, whole.max, 1e-12) << effect.kind;
  }
}

/// EYX = 10 um (u^2 - 1), u from -1 to 1 over the travel. No axis moves along Y. Less its mean it is
/// 10 um (u^2 - 1/3), RMS 10 um sqrt(1/5 - 1/9) = 2.98 um, at most 6.67 um, whatever the tables.
TEST(ErrorLeft, CountsComponentsAlongWhichNoAxisMoves) {
  const auto bow = [](double q) { return 40e-6 * q * (q - 1.0); };
  for (const char* structure : {"w b X t", "w b Z X t"}) {
    Machine machine = testing_support::machine_of(structure);
    machine.tools = {{"short", {0.0, 0.0, -0.1}, 0.0}};
    const FitResult result = testing::result_with(machine, {.functions = {{"EYX", bow}}}, 100);
    const VolumeCheck check = tables_of(result, "csv", CompensationType::volumetric()).check;
    ASSERT_TRUE(check.fixed) << structure;
    EXPECT_EQ(check.fixed->axes.size(), 3 - machine.axes.size()) << structure;
    for (const ErrorLeft& left : {check.before, check.ideal, check.exported, check.fixed->error,
                                  check.parts[1].before, check.parts[1].exported}) {
      EXPECT_NEAR(left.rms, 2.98e-6, 0.1e-6) << structure;
      EXPECT_NEAR(left.max, 6.67e-6, 0.5e-6) << structure << ": 100 places are not quite even";
    }
    EXPECT_EQ(check.parts[1].part, CompensationPart::Straightness);
  }
  EXPECT_FALSE(tables_of(testing::rotary_result("w C' A' Y' b X Z t"), "csv", CompensationType::volumetric())
                   .check.fixed);
}

/// A bump 8 mm wide that stands between the places of a lattice is left by a table of large steps.
TEST(ErrorLeft, SeesWhatIsLocal) {
  const FitResult result = stated(effect_spec("custom", {{"target", std::string("EYX")},
                                                         {"expression", std::string("exp(-((x-460)/8)^2)")},
                                                         {"amplitude", 8e-6}}));
  const TableFormat& format = *find_table_format("neutral-csv");
  TableFormatOptions options;
  options.step = 0.05;
  const MadeTables made = make_tables(format, result, options);
  EXPECT_GT(made.check.before.max, 7e-6);
  EXPECT_GT(made.check.exported.max, 5e-6);
}

TEST(IdentifiedRotaryAxes, HaveEffectsToo) {
  Machine machine = testing::rotary_machine("w C' b X Y Z t");
  ModelSpec model;
  model.default_function.basis = "zero";
  model.effects = {effect_spec("worm-error", {{"symbol", std::string("ECC")},
                                              {"period", 4.0 * std::numbers::pi / 180.0},
                                              {"cos", 20e-6},
                                              {"sin", 0.0}})};
  const FitResult result = stated_result(machine, model);
  EXPECT_THAT(identified_rotary_axes(result), ::testing::ElementsAre(AxisName::C));
  AxisPosition turned{};
  turned[index_of(AxisName::C)] = 1.0;
  EXPECT_NO_THROW(require_identified_rotary_axes(result, turned));
  const MadeTables linear = tables_of(result, "csv", CompensationType::volumetric());
  ASSERT_EQ(linear.effects_left_out.size(), 1U) << "said where the type has nothing of C";
  EXPECT_EQ(linear.effects_left_out[0].code, FindingCode::RotaryErrorsInNoTable);
}

/// Straightness with the pitch of a screw, sampled further apart than it changes.
TEST(CautionsOfTables, SayWhereTheyLeaveMore) {
  const FitResult result = stated(effect_spec(
      "lead-error", {{"symbol", std::string("EYX")}, {"period", 20e-3}, {"cos", 5e-6}, {"sin", 0.0}}));
  TableFormatOptions options;
  options.step = 47e-3;
  const MadeTables coarse = make_tables(*find_table_format("neutral-csv"), result, options);
  EXPECT_GT(coarse.check.exported.rms, coarse.check.before.rms);
  EXPECT_TRUE(is_said(coarse, FindingCode::TablesLeaveMore));
  options.step = 2e-3;
  options.type = CompensationPart::Straightness;
  const MadeTables fine = make_tables(*find_table_format("neutral-csv"), result, options);
  EXPECT_LT(fine.check.exported.rms, 0.2e-6);
  EXPECT_FALSE(is_said(fine, FindingCode::TablesLeaveMore));
}

}  // namespace
}  // namespace volcal
