#include "volcal/sim/machine/truth_machine.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/machine/transforms.h"

namespace volcal::sim {
namespace {

constexpr double kTurn90 = std::numbers::pi / 2.0;
constexpr double kHandTolerance = 1.2e-9;  // m; second order: half of (100 urad)^2 times 0.22 m

Machine metre_cube(const std::string& code) {
  return machine_from_code(code, {{{0.0, 1.0}, {0.0, 1.0}, {0.0, 1.0}}});
}

MachineState at(double x, double y, double z, double a = 0.0, double b = 0.0, double c = 0.0) {
  MachineState state;
  state.position = {x, y, z, a, b, c};
  return state;
}

void set_constant(TruthMachine& truth, const std::string& symbol, double value) {
  if (const auto motion = ErrorSymbol::parse(symbol)) {
    truth.set_error(*motion, [value](double) { return value; });
  } else {
    truth.set_location(*LocationSymbol::parse(symbol), value);
  }
}

bool is_angle(const std::string& symbol) { return symbol[1] >= 'A' && symbol[1] <= 'C'; }

/// One row of the hand tests: a single error of 10 um or 100 urad and the displacement of the tool point in
/// um.
struct HandCase {
  std::string symbol;
  Eigen::Vector3d expected_um;
};

void expect_hand_cases(const Machine& machine, const MachineState& state, const Eigen::Vector3d& tool,
                       const Eigen::Vector3d& nominal_mm, const std::vector<HandCase>& cases) {
  const TruthMachine nominal(machine);
  EXPECT_LT((nominal.point(state, tool) - 1e-3 * nominal_mm).norm(), 1e-12);
  for (const HandCase& hand : cases) {
    TruthMachine truth(machine);
    set_constant(truth, hand.symbol, is_angle(hand.symbol) ? 100e-6 : 10e-6);
    const Eigen::Vector3d error = truth.point_error(state, tool);
    EXPECT_LT((error - 1e-6 * hand.expected_um).norm(), kHandTolerance)
        << hand.symbol << ": " << 1e6 * error.transpose();
  }
}

TEST(TruthMachineHand, RotaryTable) {
  expect_hand_cases(metre_cube("w C' b X Y Z t"), at(0.1, 0, 0.05, 0, 0, kTurn90), Eigen::Vector3d::Zero(),
                    {0, 100, 50},
                    {{"EXC", {0, 10, 0}},
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

TEST(TruthMachineHand, RotaryHead) {
  expect_hand_cases(metre_cube("w b X Y Z C t"), at(0, 0, 0, 0, 0, kTurn90), {0.1, 0, -0.2}, {0, 100, -200},
                    {{"EXC", {10, 0, 0}},
                     {"EAC", {0, 20, 10}},
                     {"EBC", {-20, 0, 0}},
                     {"ECC", {-10, 0, 0}},
                     {"EX0C", {10, 0, 0}},
                     {"EA0C", {0, 20, 10}}});
}

TEST(TruthMachineHand, TableOnCradle) {
  expect_hand_cases(metre_cube("w C' A' b X Y Z t"), at(0.1, 0, 0.05, -kTurn90), Eigen::Vector3d::Zero(),
                    {100, 50, 0},
                    {{"EZC", {0, 0, 10}},
                     {"EBC", {0, 0, -10}},
                     {"ECC", {-5, 10, 0}},
                     {"EYA", {0, 0, -10}},
                     {"EBA", {5, -10, 0}}});
}

TEST(TruthMachineHand, ForkHead) {
  expect_hand_cases(metre_cube("w X' b Y Z C B t"), at(0, 0, 0, 0, kTurn90, kTurn90), {0, 0, -0.2},
                    {0, -200, 0},
                    {{"EAC", {0, 0, -20}},
                     {"EBC", {0, 0, 0}},
                     {"ECC", {20, 0, 0}},
                     {"EXB", {0, 10, 0}},
                     {"EAB", {0, 0, 0}},
                     {"EBB", {0, 0, 20}},
                     {"ECB", {20, 0, 0}}});
}

/// Physical axis line of C in the machine frame: turning the table by 1 rad is a rotation about it.
struct PhysicalLine {
  Eigen::Vector3d direction;
  Eigen::Vector3d foot;  ///< where the line meets the plane z = height
};

PhysicalLine physical_c_line(const TruthMachine& truth, double height) {
  const auto table = [&](double c) {
    return inverse(truth.pose(at(0, 0, 0, 0, 0, c), Eigen::Vector3d::Zero()));
  };
  const Eigen::Matrix4d turn = table(1.0) * inverse(table(0.0));
  PhysicalLine line;
  line.direction = -rotation_vector(turn.topLeftCorner<3, 3>()).normalized();  // a table turns by -C
  // The foot solves (turn - 1) (foot, 1) = 0 with foot.z = height.
  const Eigen::Matrix<double, 3, 2> columns = (turn - Eigen::Matrix4d::Identity()).topLeftCorner<3, 2>();
  const Eigen::Vector3d right =
      -((turn - Eigen::Matrix4d::Identity()).block<3, 1>(0, 2) * height + turn.topRightCorner<3, 1>());
  const Eigen::Vector2d foot = columns.colPivHouseholderQr().solve(right);
  line.foot = {foot.x(), foot.y(), height};
  return line;
}

TEST(TruthMachineHand, LocationErrorsAreThoseOfThePhysicalAxis) {
  Machine machine = metre_cube("w C' b X Y Z t");
  machine.axes[0].centre = {0.01, 0.02, 0.0};
  TruthMachine truth(machine);
  set_constant(truth, "EX0C", 10e-6);
  set_constant(truth, "EY0C", 20e-6);
  set_constant(truth, "EA0C", 30e-6);
  set_constant(truth, "EB0C", 50e-6);
  const Eigen::Vector3d low = physical_c_line(truth, 0.0).foot - machine.axes[0].centre;
  const Eigen::Vector3d high = physical_c_line(truth, 0.3).foot - machine.axes[0].centre;
  EXPECT_NEAR(low.x(), 10e-6, 1e-9);
  EXPECT_NEAR(low.y(), 20e-6, 1e-9);
  EXPECT_NEAR(high.x(), 25e-6, 1e-9);
  EXPECT_NEAR(high.y(), 11e-6, 1e-9);
}

TEST(TruthMachineHand, PlusFortyFiveDegreesTurnsTheTableMinusFortyFive) {
  const TruthMachine truth(metre_cube("w C' b X Y Z t"));
  const Eigen::Matrix4d table =
      inverse(truth.pose(at(0, 0, 0, 0, 0, std::numbers::pi / 4), Eigen::Vector3d::Zero()));
  EXPECT_NEAR(std::atan2(table(1, 0), table(0, 0)), -std::numbers::pi / 4, 1e-14);
}

TEST(TruthMachineHand, LocationErrorsComposeAtMachineZero) {
  Machine machine = metre_cube("w C' A' b X Y Z t");
  machine.axes[1].centre = {0.0, 0.0, 0.05};
  TruthMachine truth(machine);
  set_constant(truth, "EY0A", 10e-6);
  set_constant(truth, "EZ0A", -20e-6);
  set_constant(truth, "EB0A", 60e-6);
  set_constant(truth, "EC0A", -40e-6);
  set_constant(truth, "EX0C", 5e-6);
  set_constant(truth, "EY0C", 7e-6);
  set_constant(truth, "EA0C", 30e-6);
  set_constant(truth, "EB0C", -20e-6);
  const PhysicalLine line = physical_c_line(truth, 0.0);
  EXPECT_NEAR(line.foot.x(), 2e-6, 5e-9);
  EXPECT_NEAR(line.foot.y(), 17e-6, 5e-9);
  EXPECT_NEAR(-line.direction.y(), 30e-6, 5e-9);  // A0C tilts the axis towards -y
  EXPECT_NEAR(line.direction.x(), 40e-6, 5e-9);
}

TEST(TruthMachineHand, AbbeArmRunsFromTheReferencePoint) {
  // ISO/TR 16907:2015, Figure 6: 1,000 mm of Abbe offset in Y give 1 um of EXX per urad of ECX.
  Machine machine = metre_cube("w b X Y Z t");
  TruthMachine truth(machine);
  set_constant(truth, "ECX", 1e-6);
  const Eigen::Vector3d error = truth.point_error(at(0, 1, 0), Eigen::Vector3d::Zero());
  EXPECT_NEAR(error.x(), -1e-6, 1e-12);
  // With the scale at y = 1 m the same point has no Abbe offset.
  machine.axes[0].reference_point = {0.0, 1.0, 0.0};
  TruthMachine at_scale(machine);
  set_constant(at_scale, "ECX", 1e-6);
  EXPECT_NEAR(at_scale.point_error(at(0, 1, 0), Eigen::Vector3d::Zero()).x(), 0.0, 1e-12);
}

TEST(TruthMachineHand, WorkpieceSideArmGrowsWithItsOwnMotion) {
  // w X' b Y Z t: the table carries the workpiece, the arm of ECX from the reference point to the tool is
  // (x, y, z) with x commanded; on the tool side the carriage takes its reference point along.
  TruthMachine table(metre_cube("w X' b Y Z t"));
  set_constant(table, "ECX", 10e-6);
  EXPECT_LT((table.point_error(at(0.5, 0.2, 0.1), {0, 0, -0.1}) - Eigen::Vector3d(-2e-6, 5e-6, 0)).norm(),
            1e-10);
  TruthMachine head(metre_cube("w b X Y Z t"));
  set_constant(head, "ECX", 10e-6);
  EXPECT_LT((head.point_error(at(0.5, 0.2, 0.1), {0, 0, -0.1}) - Eigen::Vector3d(-2e-6, 0, 0)).norm(), 1e-10);
}

TEST(TruthMachineHand, SquarenessTurnsTheAxisDirection) {
  TruthMachine truth(metre_cube("w X b Y Z t"));
  set_constant(truth, "EC0Y", 10e-6);
  set_constant(truth, "EA0Z", 20e-6);
  set_constant(truth, "EB0Z", 30e-6);
  // u_Y = e_Y - EC0Y e_X, u_Z = e_Z + EB0Z e_X - EA0Z e_Y
  const Eigen::Vector3d error = truth.point_error(at(0.3, 0.4, 0.5), {0, 0, -0.15});
  EXPECT_LT((error - Eigen::Vector3d(-4e-6 + 15e-6, -10e-6, 0)).norm(), 1e-9);
  EXPECT_LT(truth.relative_rotation(at(0.3, 0.4, 0.5)).norm(), 1e-15);
}

TEST(TruthMachineHand, PrimaryZSecondaryXNamesOtherSymbols) {
  Machine machine = metre_cube("w X b Y Z t");
  machine.datum = {AxisName::Z, AxisName::X};
  TruthMachine truth(machine);
  set_constant(truth, "EB0X", 10e-6);  // u_X = e_X + EB0X e_Y x e_X = e_X - EB0X e_Z
  set_constant(truth, "EA0Y", 20e-6);  // u_Y = e_Y + EC0Y e_Z x e_Y + EA0Y e_X x e_Y
  set_constant(truth, "EC0Y", 30e-6);
  const Eigen::Vector3d error = truth.point_error(at(0.1, 0.2, 0.3), Eigen::Vector3d::Zero());
  EXPECT_LT((error - Eigen::Vector3d(-6e-6, 0, -1e-6 + 4e-6)).norm(), 1e-9);
  EXPECT_THROW(truth.set_location(*LocationSymbol::parse("EA0Z"), 1e-6), std::invalid_argument);
}

TEST(TruthMachine, RotationsAreThreeTwoOneAndExact) {
  TruthMachine truth(metre_cube("w b X Y Z t"));
  set_constant(truth, "EAX", 0.1);
  set_constant(truth, "EBX", 0.2);
  set_constant(truth, "ECX", 0.3);
  const Eigen::Matrix3d expected =
      (Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  const Eigen::Matrix4d pose = truth.pose(at(0, 0, 0), Eigen::Vector3d::Zero());
  EXPECT_LT((pose.topLeftCorner<3, 3>() - expected).norm(), 1e-15);
}

TEST(TruthMachine, ReversalExpansionAndStateErrorsAddUp) {
  TruthMachine truth(metre_cube("w b X Y Z t"));
  const ErrorSymbol exx = *ErrorSymbol::parse("EXX");
  truth.set_error(exx, [](double q) { return 5e-6 * q; });
  truth.set_reversal(exx, 4e-6);
  truth.set_scale_expansion(AxisName::X, 10e-6, "X");
  truth.add_state_error(exx, [](const MachineState& state) { return 1e-6 * state.position[1]; });
  MachineState state = at(0.5, 0.2, 0.0);
  state.temperature["X"] = 21.5;
  state.direction[0] = -1;
  // 5 um/m x 0.5 m - 4/2 um + 10 um/m/K x 1.5 K x 0.5 m + 1 um/m x 0.2 m
  EXPECT_NEAR(truth.error(exx, state), 2.5e-6 - 2e-6 + 7.5e-6 + 0.2e-6, 1e-15);
  state.direction[0] = 0;
  EXPECT_NEAR(truth.error(exx, state), 2.5e-6 + 7.5e-6 + 0.2e-6, 1e-15);
  EXPECT_THROW(truth.error(exx, at(0.5, 0.2, 0.0)), std::invalid_argument);
}

TEST(TruthMachine, TableRotationIsMinusTheWorkpieceSideError) {
  TruthMachine truth(metre_cube("w X' b Y Z t"));
  set_constant(truth, "EAX", 10e-6);
  set_constant(truth, "EBY", 20e-6);
  const MachineState state = at(0.1, 0.2, 0.3);
  EXPECT_LT((truth.relative_rotation(state) - Eigen::Vector3d(10e-6, 20e-6, 0)).norm(), 1e-9);
  EXPECT_LT((truth.tool_rotation(state) - Eigen::Vector3d(0, 20e-6, 0)).norm(), 1e-12);
  EXPECT_LT((truth.table_rotation(state) - Eigen::Vector3d(-10e-6, 0, 0)).norm(), 1e-12);
}

TEST(Transforms, InverseAndRotationVectorAndAlignment) {
  const Eigen::Matrix4d t = translation({1, 2, 3}) * rotation_321({0.3, -0.2, 0.5});
  EXPECT_LT((t * inverse(t) - Eigen::Matrix4d::Identity()).norm(), 1e-15);
  const Eigen::AngleAxisd turn(1.2, Eigen::Vector3d(1, 2, -2).normalized());
  EXPECT_LT((rotation_vector(turn.toRotationMatrix()) - turn.angle() * turn.axis()).norm(), 1e-14);
  EXPECT_EQ(rotation_vector(Eigen::Matrix3d::Identity()).norm(), 0.0);

  const std::vector<Eigen::Vector3d> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  std::vector<Eigen::Vector3d> errors;
  errors.reserve(points.size());
  const RigidMotion motion{{1, -2, 3}, {0.1, 0.2, -0.3}};
  for (const Eigen::Vector3d& p : points) errors.emplace_back(motion.translation + motion.rotation.cross(p));
  const RigidMotion found = best_rigid_motion(points, errors);
  EXPECT_LT((found.translation - motion.translation).norm(), 1e-14);
  EXPECT_LT((found.rotation - motion.rotation).norm(), 1e-14);
  EXPECT_LT(rms_after_alignment(points, errors), 1e-14);
}

}  // namespace
}  // namespace volcal::sim
