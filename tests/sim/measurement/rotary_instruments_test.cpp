#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include "volcal/sim/machine/random_truth.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/measurement/instruments.h"
#include "volcal/sim/measurement/measurements.h"

namespace volcal::sim {
namespace {

constexpr double kHandError = 10e-6;         // m
constexpr double kHandTilt = 100e-6;         // rad
constexpr double kRotarySecondOrder = 2e-8;  // m: tilts of 100 urad over 0.2 m
constexpr double kOneDegree = std::numbers::pi / 180.0;

/// A machine, a pose, and what one error does to the tool point there, um.
struct HandPose {
  const char* code;
  std::map<AxisName, double> position;  ///< m, deg
  Eigen::Vector3d tool;                 ///< m
  Eigen::Vector3d point_w;              ///< m
};

struct HandRow {
  const char* symbol;  ///< of a motion or of a location error
  Eigen::Vector3d displacement_um;
};

class RotaryReadings : public ::testing::Test {
 protected:
  static TruthMachine machine_of(const HandPose& pose) {
    Machine machine = machine_from_code(pose.code, {{{-1, 1}, {-1, 1}, {-1, 1}}});
    machine.tools = {{"tool", pose.tool, 0.0}};
    return TruthMachine(machine);
  }
  static CommandedPoint commanded(const HandPose& pose) {
    CommandedPoint point;
    for (const auto& [axis, value] : pose.position)
      point.position[index_of(axis)] = is_rotary(axis) ? value * kOneDegree : value;
    return point;
  }
  static void set(TruthMachine& truth, const std::string& name) {
    if (const auto location = LocationSymbol::parse(name)) {
      truth.set_location(*location, is_rotation(location->component) ? kHandTilt : kHandError);
      return;
    }
    const ErrorSymbol symbol = *ErrorSymbol::parse(name);
    truth.set_error(symbol,
                    [size = is_rotation(symbol.component) ? kHandTilt : kHandError](double) { return size; });
  }
  static Eigen::Vector3d read(const TruthMachine& truth, const HandPose& pose, const std::string& instrument,
                              const std::string& frame = "workpiece") {
    SetupPlan plan;
    plan.name = "S";
    plan.instrument = instrument;
    plan.points = {commanded(pose)};
    plan.options.set("frame", frame);
    plan.truth.sphere = kSphere;
    const Environment environment;
    const auto value = measure(plan, {truth, environment, {pose.tool}, 1, false, true}, 0.0).readings.value;
    return {value.at(0)[0], value.at(1)[0], value.at(2)[0]};
  }
  static void expect_rows(const HandPose& pose, const std::vector<HandRow>& rows) {
    const TruthMachine nominal = machine_of(pose);
    MachineState state;
    state.position = commanded(pose).position;
    EXPECT_LT((nominal.nominal_point(state, pose.tool) - pose.point_w).norm(), 1e-15) << pose.code;
    for (const HandRow& row : rows) {
      TruthMachine truth = machine_of(pose);
      set(truth, row.symbol);
      const Eigen::Vector3d displacement = 1e-6 * row.displacement_um;
      EXPECT_LT((read(truth, pose, kRTest) - kSphere - displacement).norm(), kRotarySecondOrder)
          << pose.code << " " << row.symbol << " " << (read(truth, pose, kRTest) - kSphere).transpose();
      EXPECT_LT((read(truth, pose, kProbedSphere) - kSphere + displacement).norm(), kRotarySecondOrder)
          << pose.code << " " << row.symbol;
    }
  }

  static inline const Eigen::Vector3d kSphere{7e-6, -3e-6, 2e-6};
};

// The displacements are those of the first-order formula, by hand: with x the tool point in the stator frame,
// R_(w<-s) [e + eps x (x - p)], e and eps with the sign of the side for location errors.

TEST_F(RotaryReadings, OfATableAtAQuarterTurn) {
  const HandPose pose{"w C' b X Y Z t",
                      {{AxisName::C, 90.0}, {AxisName::X, 0.1}, {AxisName::Z, 0.05}},
                      {0.0, 0.0, 0.0},
                      {0.0, 0.1, 0.05}};
  expect_rows(pose, {{"EXC", {0, 10, 0}},
                     {"EYC", {-10, 0, 0}},
                     {"EZC", {0, 0, 10}},
                     {"EAC", {5, 0, 0}},
                     {"EBC", {0, 5, -10}},
                     {"ECC", {-10, 0, 0}},
                     {"EX0C", {0, -10, 0}},
                     {"EY0C", {10, 0, 0}},
                     {"EA0C", {-5, 0, 0}},
                     {"EB0C", {0, -5, 10}},
                     {"EC0C", {-10, 0, 0}}});
}

TEST_F(RotaryReadings, OfAHeadWithAnOffsetTool) {
  const HandPose pose{"w b X Y Z C t", {{AxisName::C, 90.0}}, {0.1, 0.0, -0.2}, {0.0, 0.1, -0.2}};
  expect_rows(pose, {{"EXC", {10, 0, 0}},
                     {"EAC", {0, 20, 10}},
                     {"EBC", {-20, 0, 0}},
                     {"ECC", {-10, 0, 0}},
                     {"EX0C", {10, 0, 0}},
                     {"EA0C", {0, 20, 10}}});
}

TEST_F(RotaryReadings, OfATrunnion) {
  const HandPose pose{"w C' A' b X Y Z t",
                      {{AxisName::A, -90.0}, {AxisName::X, 0.1}, {AxisName::Z, 0.05}},
                      {0.0, 0.0, 0.0},
                      {0.1, 0.05, 0.0}};
  expect_rows(pose, {{"EZC", {0, 0, 10}},
                     {"EBC", {0, 0, -10}},
                     {"ECC", {-5, 10, 0}},
                     {"EYA", {0, 0, -10}},
                     {"EBA", {5, -10, 0}}});
}

TEST_F(RotaryReadings, OfATwoAxisHead) {
  const HandPose pose{
      "w X' b Y Z C B t", {{AxisName::C, 90.0}, {AxisName::B, 90.0}}, {0.0, 0.0, -0.2}, {0.0, -0.2, 0.0}};
  expect_rows(pose, {{"EAC", {0, 0, -20}},
                     {"EBC", {0, 0, 0}},
                     {"ECC", {20, 0, 0}},
                     {"EXB", {0, 10, 0}},
                     {"EAB", {0, 0, 0}},
                     {"EBB", {0, 0, 20}},
                     {"ECB", {20, 0, 0}}});
}

TEST_F(RotaryReadings, InTheAxesOfToolAndMachine) {
  const HandPose table{"w C' b X Y Z t",
                       {{AxisName::C, 90.0}, {AxisName::X, 0.1}, {AxisName::Z, 0.05}},
                       {0.0, 0.0, 0.0},
                       {0.0, 0.1, 0.05}};
  TruthMachine truth = machine_of(table);
  set(truth, "EYC");
  // (-10, 0, 0) um in workpiece coordinates, whose x is the machine's y turned back: +y of machine and tool.
  for (const char* frame : {"machine", "tool"}) {
    EXPECT_LT((read(truth, table, kRTest, frame) - kSphere - Eigen::Vector3d(0, kHandError, 0)).norm(),
              kRotarySecondOrder)
        << frame << ": the offset stays as it is in the frame of the readings";
  }
  const HandPose head{"w b X Y Z C t", {{AxisName::C, 90.0}}, {0.1, 0.0, -0.2}, {0.0, 0.1, -0.2}};
  TruthMachine turned = machine_of(head);
  set(turned, "EXC");
  EXPECT_LT((read(turned, head, kRTest, "machine") - kSphere - Eigen::Vector3d(kHandError, 0, 0)).norm(),
            kRotarySecondOrder);
  EXPECT_LT((read(turned, head, kRTest, "tool") - kSphere - Eigen::Vector3d(0, -kHandError, 0)).norm(),
            kRotarySecondOrder);
  EXPECT_THROW(read(turned, head, kRTest, "bed"), std::invalid_argument);
}

/// A trunnion with errors of every axis, position by position.
Machine probed_machine() {
  Machine machine = machine_from_code("w C' A' Y' b X Z t", {{{-0.4, 0.4}, {-0.4, 0.4}, {-0.4, 0.4}}});
  for (Axis& axis : machine.axes) {
    if (axis.name == AxisName::A) {
      axis.travel_min = -0.5;
      axis.travel_max = 0.5;
    }
  }
  return machine;
}

TEST(SingleContacts, TouchTheSphereWithTheErrorsOfTheirOwnJoints) {
  const Machine machine = probed_machine();
  const TruthMachine truth = random_truth(machine, 9);
  ProbedSphere settings;
  settings.poses.spheres = {{"P1", {0.05, -0.03, 0.02}}};
  settings.poses.tools = {"short"};
  settings.poses.grid.points = {{AxisName::A, 3}, {AxisName::C, 4}};
  settings.contacts = true;
  settings.radius_error = 4e-6;
  const std::vector<SetupPlan> plans = plan_setups({"", settings}, machine, 3);
  ASSERT_EQ(plans.size(), 3U);
  const Environment environment;
  const Eigen::Vector3d tool = machine.tools[0].offset;
  for (const SetupPlan& plan : plans) {
    const volcal::Setup setup = measure(plan, {truth, environment, {tool, tool, tool}, 1, false, true}, 0.0);
    EXPECT_EQ(setup.readings.column_set, 1U);
    ASSERT_EQ(setup.readings.value.size(), 1U);
    ASSERT_EQ(setup.readings.given.size(), 6U);
    EXPECT_EQ(setup.readings.size(), plan.name.ends_with("W") ? 12U : 24U) << "both sides across the tool";
    EXPECT_EQ(*setup.options.text("sphere"), "P1");
    EXPECT_EQ(*setup.options.text("contact"), plan.name.substr(plan.name.size() - 1));
    EXPECT_GT((plan.truth.sphere - Eigen::Vector3d(0.05, -0.03, 0.02)).norm(), 5e-6);
    double radius_error = std::abs(plan.truth.contact_radius - settings.radius);
    EXPECT_GT(radius_error, 1e-9);
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      const auto column = [&](std::size_t k) { return setup.readings.given[k][row]; };
      const Eigen::Vector3d tip{column(0), column(1), column(2)}, normal{column(3), column(4), column(5)};
      MachineState state;
      for (const AxisName axis : kAllAxes) {
        const auto& positions = setup.readings.position[index_of(axis)];
        if (!positions.empty()) state.position[index_of(axis)] = positions[row];
      }
      EXPECT_NEAR(normal.norm(), 1.0, 1e-14);
      EXPECT_LT((truth.nominal_point(state, tool) - tip).norm(), 1e-15) << "the control's own kinematics";
      const Eigen::Vector3d error = truth.point_error(state, tool);
      EXPECT_GT(error.norm(), 1e-6);
      EXPECT_NEAR(normal.dot(tip + error - plan.truth.sphere), plan.truth.contact_radius, 1e-14);
      const Eigen::Vector3d from_centre = tip - plan.truth.sphere;
      EXPECT_GT(from_centre.normalized().dot(normal), 0.99) << "outward";
    }
  }
}

TEST(SingleContacts, NoiseActsAlongTheNormal) {
  const Machine machine = probed_machine();
  const TruthMachine truth(machine);
  ProbedSphere settings;
  settings.poses.spheres = {{"P1", {0.05, -0.03, 0.02}}};
  settings.poses.tools = {"short"};
  settings.poses.grid.points = {{AxisName::A, 5}, {AxisName::C, 24}};
  settings.contacts = true;
  settings.kinds = {"U"};
  settings.radius_sigma = 0.0;
  settings.noise = {2e-6, 0.0, 0.0, 0.0};
  const SetupPlan plan = plan_setups({"", settings}, machine, 3).front();
  EXPECT_EQ(plan.truth.contact_radius, settings.radius) << "calibrated";
  const Environment environment;
  const std::vector<Eigen::Vector3d> tools(3, machine.tools[0].offset);
  const volcal::Setup quiet = measure(plan, {truth, environment, tools, 1, false, true}, 0.0);
  const volcal::Setup noisy = measure(plan, {truth, environment, tools, 1, false, false}, 0.0);
  const auto &before = quiet.readings.value, &after = noisy.readings.value;
  ASSERT_EQ(before.size(), 1U);
  double square = 0.0;
  for (std::size_t row = 0; row < quiet.readings.size(); ++row) {
    Eigen::Vector3d shift, normal;
    for (std::size_t k = 0; k < 3; ++k) {
      shift[static_cast<int>(k)] = noisy.readings.given[k][row] - quiet.readings.given[k][row];
      normal[static_cast<int>(k)] = quiet.readings.given[k + 3][row];
    }
    const double along = after[0][row] - before[0][row];
    EXPECT_LT((shift - along * normal).norm(), 1e-15);
    square += along * along;
  }
  // 240 draws of 2 um: the root mean square is within 5 standard errors (2 / sqrt(480)) of it.
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(quiet.readings.size())), 2e-6, 0.46e-6);
}

}  // namespace
}  // namespace volcal::sim
