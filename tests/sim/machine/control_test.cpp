// The simulated control by hand: interpolation, directions, signs, steps, and machines that apply it.

#include "volcal/sim/machine/control.h"

#include <gtest/gtest.h>

#include "tests/support/machines.h"
#include "volcal/sim/study.h"

namespace volcal::sim {
namespace {

constexpr double kMicro = 1e-6;

MachineState state_at(double x, double y, double z, int direction) {
  MachineState state;
  state.position = {x, y, z, 0.0, 0.0, 0.0};
  state.direction.fill(static_cast<std::int8_t>(direction));
  return state;
}

ControlAxisTable table_of_x() {
  return {.input = AxisName::X,
          .output = AxisName::Y,
          .position = {0.0, 0.5, 1.0},
          .towards_plus = {0.0, 4 * kMicro, 6 * kMicro},
          .towards_minus = {2 * kMicro, 8 * kMicro, 10 * kMicro}};
}

Eigen::Vector3d added(const ActiveCompensation& compensation, const MachineState& state) {
  return command_correction(compensation)(state).linear;
}

TEST(Control, AxisTablesAreLinearBetweenPositionsAndHeldBeyond) {
  ActiveCompensation compensation;
  compensation.tables.axis_tables = {table_of_x()};
  EXPECT_NEAR(added(compensation, state_at(0.25, 0, 0, 1)).y(), 2e-6, 1e-18);
  EXPECT_NEAR(added(compensation, state_at(0.75, 0, 0, 1)).y(), 5e-6, 1e-18);
  EXPECT_NEAR(added(compensation, state_at(-3.0, 0, 0, 1)).y(), 0.0, 1e-18);
  EXPECT_NEAR(added(compensation, state_at(9.0, 0, 0, -1)).y(), 10e-6, 1e-18);
  EXPECT_EQ(added(compensation, state_at(0.25, 0, 0, 1)).x(), 0.0);
}

TEST(Control, DirectionChoosesTheColumnAndNoneTheirMean) {
  ActiveCompensation compensation;
  compensation.tables.axis_tables = {table_of_x()};
  EXPECT_NEAR(added(compensation, state_at(0.5, 0, 0, 1)).y(), 4e-6, 1e-18);
  EXPECT_NEAR(added(compensation, state_at(0.5, 0, 0, -1)).y(), 8e-6, 1e-18);
  EXPECT_NEAR(added(compensation, state_at(0.5, 0, 0, 0)).y(), 6e-6, 1e-18);
}

TEST(Control, ErrorsAreSubtracted) {
  ActiveCompensation compensation;
  compensation.tables.axis_tables = {table_of_x()};
  compensation.tables.axis_tables[0].meaning = TableValue::Error;
  EXPECT_NEAR(added(compensation, state_at(0.5, 0, 0, 1)).y(), -4e-6, 1e-18);
}

// x z um at the corners of a grid of two nodes per axis, and 2 um of reversal of Y in z.
TEST(Control, GridsAreTrilinear) {
  ControlGrid grid;
  grid.nodes = {{{0.0, 1.0}, {0.0, 1.0}, {0.0, 1.0}}};
  for (const double x : {0.0, 1.0}) {
    for (int y = 0; y < 2; ++y) {
      for (const double z : {0.0, 1.0}) {
        grid.mean.emplace_back(x * z * kMicro, 0.0, 0.0);
        grid.reversal[1].emplace_back(0.0, 0.0, 2 * kMicro);
      }
    }
  }
  ActiveCompensation compensation;
  compensation.tables.grids = {grid};
  const Eigen::Vector3d plus = added(compensation, state_at(0.5, 0.3, 0.25, 1));
  EXPECT_NEAR(plus.x(), 0.125e-6, 1e-18);
  EXPECT_NEAR(plus.z(), 1e-6, 1e-18);
  EXPECT_NEAR(added(compensation, state_at(0.5, 0.3, 0.25, -1)).z(), -1e-6, 1e-18);
  EXPECT_NEAR(added(compensation, state_at(2.0, 0.3, 7.0, 0)).x(), 1e-6, 1e-18) << "held beyond the ends";
}

TEST(Control, FirmwareSubtractsSkew) {
  ActiveCompensation compensation;
  compensation.tables.skews = {{.xy = 30e-6, .xz = -20e-6, .yz = 10e-6}};
  const Eigen::Vector3d c = added(compensation, state_at(0.0, 1.0, 0.5, 1));
  EXPECT_NEAR(c.x(), -30e-6 + 0.5 * 20e-6, 1e-9);
  EXPECT_NEAR(c.y(), -5e-6, 1e-18);
}

TEST(Control, CorrectionsComeInWholeSteps) {
  ActiveCompensation compensation;
  compensation.tables.axis_tables = {table_of_x()};
  compensation.least_increment = 1e-6;
  EXPECT_NEAR(added(compensation, state_at(0.3, 0, 0, 1)).y(), 2e-6, 1e-18) << "2.4 um";
  EXPECT_NEAR(added(compensation, state_at(0.35, 0, 0, 1)).y(), 3e-6, 1e-18) << "2.8 um";
}

// EBX = 10 urad at x = 1 m moves the point of a tool of -200 mm by -2 um in x. The control knows it, and
// adds 2 um; the compensation stands in the table as minus the error.
TEST(Control, ModelsUseTheToolThatTheyWereTold) {
  ControlModel model{testing_support::machine_of("w b X Y Z t"), {0.0, 0.0, -0.2}, {}, {}, {}};
  model.motions[*ErrorSymbol::parse("EBX")] = {.input = AxisName::X,
                                               .output = AxisName::X,
                                               .position = {0.0, 1.0},
                                               .towards_plus = {0.0, -10e-6},
                                               .towards_minus = {0.0, -10e-6}};
  ActiveCompensation compensation;
  compensation.tables.models = {model};
  EXPECT_NEAR(added(compensation, state_at(1.0, 0.0, 0.0, 1)).x(), 2e-6, 1e-10);
  EXPECT_NEAR(added(compensation, state_at(0.0, 0.0, 0.0, 1)).norm(), 0.0, 1e-15);
}

// EXX = 10 um/m is gone where the control subtracts it; what is nominal has not moved.
TEST(CompensatedMachine, GoesWhereItWasProgrammedTo) {
  TruthMachine machine(testing_support::machine_of("w X' b Y Z t"));
  machine.set_error(*ErrorSymbol::parse("EXX"), [](double q) { return 10e-6 * q; });
  const Eigen::Vector3d tool(0.0, 0.0, -0.1);
  const MachineState state = state_at(0.8, 0.2, 0.1, 1);
  EXPECT_NEAR(machine.point_error(state, tool).x(), 8e-6, 1e-15);
  const Eigen::Vector3d nominal = machine.nominal_point(state, tool);
  ActiveCompensation compensation;
  compensation.tables.axis_tables = {{.input = AxisName::X,
                                      .output = AxisName::X,
                                      .meaning = TableValue::Error,
                                      .position = {0.0, 1.0},
                                      .towards_plus = {0.0, 10e-6},
                                      .towards_minus = {0.0, 10e-6}}};
  machine.set_correction(command_correction(compensation));
  EXPECT_NEAR(machine.point_error(state, tool).norm(), 0.0, 1e-10);
  EXPECT_EQ(machine.nominal_point(state, tool), nominal);
}

// A level shows the same angle whether the control corrects the point or not (ISO/TR 16907, 8.2.5).
TEST(CompensatedMachine, KeepsItsAngles) {
  TruthMachine machine(testing_support::machine_of("w X' b Y Z t"));
  machine.set_error(*ErrorSymbol::parse("EBX"), [](double q) { return 20e-6 * q; });
  const MachineState state = state_at(1.0, 0.0, 0.0, 1);
  const double angle = machine.relative_rotation(state).y();
  ActiveCompensation compensation;
  compensation.tables.axis_tables = {table_of_x()};
  machine.set_correction(command_correction(compensation));
  EXPECT_NEAR(machine.relative_rotation(state).y(), angle, 1e-9);
  EXPECT_NEAR(angle, 20e-6, 1e-12);
}

// A tool that is 50 mm longer than the control knows is stated as the control knows it.
TEST(CompensatedMachine, MayHaveALongerToolThanItsFileSays) {
  Study study;
  study.machine = testing_support::machine_of("w X' b Y Z t");
  study.machine.tools = {{"mill", {0.0, 0.0, -0.1}, 0.0}};
  study.truth.perfect = true;
  study.measurements.emplace_back().settings = PointGrid{};
  study.wrong_tool_length = 0.05;
  study.compensation.description = "by hand";
  const SimulatedCampaign simulated = simulate(study);
  EXPECT_NEAR(simulated.tool_offsets[0].z(), -0.15, 1e-15);
  EXPECT_EQ(simulated.campaign.machine.tools[0].offset.z(), -0.1);
  EXPECT_EQ(simulated.campaign.active_compensations, "by hand");
}

}  // namespace
}  // namespace volcal::sim
