// Functional-point errors of machines worked by hand: one error at a time, exact and first order.

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "tests/support/machines.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using testing_support::error_of;
using testing_support::machine_of;

constexpr double kMillimetre = 1e-3;
constexpr double kMicrometre = 1e-6;
constexpr double kMicroradian = 1e-6;
constexpr double kQuarterTurn = std::numbers::pi / 2;

struct Expected {
  std::string symbol;
  Vector3d error_um;  ///< of the functional point, workpiece coordinates, for 10 um or 100 urad
};

struct Pose {
  std::string structure;
  AxisPosition position;  ///< m and rad, X Y Z A B C
  Vector3d tool_mm;
  Vector3d nominal_mm;  ///< functional point in workpiece coordinates
};

bool is_angle(const std::string& symbol) { return std::string("ABC").find(symbol[1]) != std::string::npos; }

void expect_errors(const Pose& pose, const std::vector<Expected>& rows) {
  const KinematicChain chain(machine_of(pose.structure));
  const Vector3d tool = pose.tool_mm * kMillimetre;
  const Vector3d nominal = pose.nominal_mm * kMillimetre;
  EXPECT_LT((chain.nominal_point_w(pose.position, tool) - nominal).norm(), 1e-15);
  for (const Expected& row : rows) {
    PoseErrors<double> errors;
    error_of(errors, row.symbol) = is_angle(row.symbol) ? 100 * kMicroradian : 10 * kMicrometre;
    const Vector3d first_order = chain.first_order(pose.position, tool, errors).displacement_w / kMicrometre;
    const Vector3d exact =
        (chain.exact_pose<double>(pose.position, tool, errors).point_w - nominal) / kMicrometre;
    EXPECT_LT((first_order - row.error_um).norm(), 1e-9) << row.symbol << ": " << first_order.transpose();
    EXPECT_LT((exact - row.error_um).norm(), 1.2e-3) << row.symbol << ": " << exact.transpose();
  }
}

TEST(KinematicsByHand, RotaryTable) {
  expect_errors({.structure = "w C' b X Y Z t",
                 .position = {0.1, 0, 0.05, 0, 0, kQuarterTurn},
                 .tool_mm = {0, 0, 0},
                 .nominal_mm = {0, 100, 50}},
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

TEST(KinematicsByHand, RotaryHead) {
  expect_errors({.structure = "w b X Y Z C t",
                 .position = {0, 0, 0, 0, 0, kQuarterTurn},
                 .tool_mm = {100, 0, -200},
                 .nominal_mm = {0, 100, -200}},
                {{"EXC", {10, 0, 0}},
                 {"EAC", {0, 20, 10}},
                 {"EBC", {-20, 0, 0}},
                 {"ECC", {-10, 0, 0}},
                 {"EX0C", {10, 0, 0}},
                 {"EA0C", {0, 20, 10}}});
}

TEST(KinematicsByHand, Trunnion) {
  expect_errors({.structure = "w C' A' b X Y Z t",
                 .position = {0.1, 0, 0.05, -kQuarterTurn, 0, 0},
                 .tool_mm = {0, 0, 0},
                 .nominal_mm = {100, 50, 0}},
                {{"EZC", {0, 0, 10}},
                 {"EBC", {0, 0, -10}},
                 {"ECC", {-5, 10, 0}},
                 {"EYA", {0, 0, -10}},
                 {"EBA", {5, -10, 0}}});
}

TEST(KinematicsByHand, TwoAxisHead) {
  expect_errors({.structure = "w X' b Y Z C B t",
                 .position = {0, 0, 0, 0, kQuarterTurn, kQuarterTurn},
                 .tool_mm = {0, 0, -200},
                 .nominal_mm = {0, -200, 0}},
                {{"EAC", {0, 0, -20}},
                 {"EBC", {0, 0, 0}},
                 {"ECC", {20, 0, 0}},
                 {"EXB", {0, 10, 0}},
                 {"EAB", {0, 0, 0}},
                 {"EBB", {0, 0, 20}},
                 {"ECB", {20, 0, 0}}});
}

/// Machine position (C at `angle`) that brings the tool, of zero offset, onto a point of the workpiece.
Vector3d position_that_meets(const KinematicChain& chain, const PoseErrors<double>& errors,
                             const Vector3d& point_w, double angle) {
  AxisPosition position{};
  position[index_of(AxisName::C)] = angle;
  for (int iteration = 0; iteration < 6; ++iteration) {
    const auto pose = chain.exact_pose<double>(position, Vector3d(Vector3d::Zero()), errors);
    const Vector3d step = pose.rotation_wt.transpose() * (point_w - pose.point_w);
    for (std::size_t k = 0; k < 3; ++k) position[k] += step[static_cast<Eigen::Index>(k)];
  }
  return {position[0], position[1], position[2]};
}

/// Centre of the circle that a point of the table describes in machine coordinates.
Vector3d circle_centre(const KinematicChain& chain, const PoseErrors<double>& errors,
                       const Vector3d& point_w) {
  const double half_turn = std::numbers::pi;
  return 0.5 * (position_that_meets(chain, errors, point_w, 0.0) +
                position_that_meets(chain, errors, point_w, half_turn));
}

TEST(KinematicsByHand, LocationErrorsPlaceTheTableAxis) {
  Machine machine = machine_of("w C' b X Y Z t");
  machine.axes[0].centre = Vector3d(10, 20, 0) * kMillimetre;
  const KinematicChain chain(machine);
  PoseErrors<double> errors;
  error_of(errors, "EX0C") = 10 * kMicrometre;
  error_of(errors, "EY0C") = 20 * kMicrometre;
  error_of(errors, "EA0C") = 30 * kMicroradian;
  error_of(errors, "EB0C") = 50 * kMicroradian;
  // Axis line at height h: (10 + 50e-6 h, 20 - 30e-6 h); 25 and 11 um at 300 mm.
  const auto centre_um = [&](double height_mm) -> Vector3d {
    const Vector3d point_w = Vector3d(60, 20, height_mm) * kMillimetre;
    return (circle_centre(chain, errors, point_w) - machine.axes[0].centre) / kMicrometre;
  };
  EXPECT_LT((centre_um(0).head<2>() - Eigen::Vector2d(10, 20)).norm(), 1e-3);
  EXPECT_LT((centre_um(300).head<2>() - Eigen::Vector2d(25, 11)).norm(), 1e-3);
}

TEST(KinematicsByHand, PositiveCommandTurnsTheTableBackwards) {
  const KinematicChain chain(machine_of("w C' b X Y Z t"));
  const double eighth_turn = std::numbers::pi / 4;
  const Vector3d met = position_that_meets(chain, {}, Vector3d(0.1, 0, 0), eighth_turn);
  EXPECT_LT((met - 0.1 * Vector3d(std::sqrt(0.5), -std::sqrt(0.5), 0)).norm(), 1e-14);
}

/// Location errors of a cradle act on the axis that it carries: at machine zero
/// alpha = alpha_C + alpha_A = (30, 40) urad and
/// d = d_C + d_A + alpha_A x (p_C - p_A) = (5 - 60e-6 * 50e3, 7 + 10) = (2, 17) um.
TEST(KinematicsByHand, LocationErrorsComposeOnATrunnion) {
  Machine machine = machine_of("w C' A' b X Y Z t");
  machine.axes[1].centre = Vector3d(0, 0, 50) * kMillimetre;
  const KinematicChain chain(machine);
  PoseErrors<double> errors;
  error_of(errors, "EY0A") = 10 * kMicrometre;
  error_of(errors, "EZ0A") = -20 * kMicrometre;
  error_of(errors, "EB0A") = 60 * kMicroradian;
  error_of(errors, "EC0A") = -40 * kMicroradian;
  error_of(errors, "EX0C") = 5 * kMicrometre;
  error_of(errors, "EY0C") = 7 * kMicrometre;
  error_of(errors, "EA0C") = 30 * kMicroradian;
  error_of(errors, "EB0C") = -20 * kMicroradian;
  for (const double height_mm : {0.0, 300.0}) {
    const Vector3d centre = circle_centre(chain, errors, Vector3d(50, 0, height_mm) * kMillimetre);
    const Eigen::Vector2d expected_um(2 + 40e-3 * height_mm, 17 - 30e-3 * height_mm);
    EXPECT_LT((centre.head<2>() / kMicrometre - expected_um).norm(), 5e-3) << height_mm;
  }
}

/// Arms of a three-axis machine, in mm: functional point P = (350, 420, 190) for X 300, Y 400, Z 500 and tool
/// (50, 20, -310). X' moves the workpiece: arm P - r. Y and Z move the tool: arm of Y is tool + (0, 0, 500) -
/// r, of Z tool - r.
TEST(KinematicsByHand, ArmsOfThreeLinearAxes) {
  Machine machine = machine_of("w X' b Y Z t");
  machine.axes[0].reference_point = Vector3d(100, -200, 30) * kMillimetre;
  machine.axes[1].reference_point = Vector3d(-40, 10, 250) * kMillimetre;
  machine.axes[2].reference_point = Vector3d(5, 6, 7) * kMillimetre;
  const KinematicChain chain(machine);
  std::array<JointLever, 3> levers;
  const Vector3d point =
      chain.levers({0.3, 0.4, 0.5, 0, 0, 0}, Vector3d(50, 20, -310) * kMillimetre, levers.data());
  EXPECT_LT((point / kMillimetre - Vector3d(350, 420, 190)).norm(), 1e-10);
  EXPECT_LT((levers[0].arm_s / kMillimetre - Vector3d(250, 620, 160)).norm(), 1e-10);
  EXPECT_LT((levers[1].arm_s / kMillimetre - Vector3d(90, 10, -60)).norm(), 1e-10);
  EXPECT_LT((levers[2].arm_s / kMillimetre - Vector3d(45, 14, -317)).norm(), 1e-10);
}

/// Datum X, Y: u_Y = e_Y - EC0Y e_X and u_Z = e_Z + EB0Z e_X - EA0Z e_Y.
TEST(KinematicsByHand, SquarenessTurnsTheDirectionOfTravel) {
  const KinematicChain chain(machine_of("w X' b Y Z t"));
  const AxisPosition position = {0.3, 0.4, 0.5, 0, 0, 0};
  const std::vector<Expected> rows = {{"EC0Y", {-40, 0, 0}}, {"EA0Z", {0, -50, 0}}, {"EB0Z", {50, 0, 0}}};
  for (const Expected& row : rows) {
    PoseErrors<double> errors;
    error_of(errors, row.symbol) = 100 * kMicroradian;
    const ToolTwist twist = chain.first_order(position, Vector3d(0, 0, -0.2), errors);
    EXPECT_LT((twist.displacement_w / kMicrometre - row.error_um).norm(), 1e-10) << row.symbol;
    EXPECT_EQ(twist.rotation_tool_side_w.norm() + twist.rotation_workpiece_side_w.norm(), 0.0);
  }
}

TEST(KinematicsByHand, RotationsAreSplitByTheBed) {
  const KinematicChain chain(machine_of("w X' b Y Z t"));
  PoseErrors<double> errors;
  error_of(errors, "EAX") = 1 * kMicroradian;
  error_of(errors, "EBY") = 2 * kMicroradian;
  error_of(errors, "ECZ") = 3 * kMicroradian;
  const ToolTwist twist = chain.first_order({}, Vector3d::Zero(), errors);
  EXPECT_EQ(twist.rotation_workpiece_side_w, Vector3d(1, 0, 0) * kMicroradian);
  EXPECT_EQ(twist.rotation_tool_side_w, Vector3d(0, 2 * kMicroradian, 3 * kMicroradian));
}

}  // namespace
}  // namespace volcal
