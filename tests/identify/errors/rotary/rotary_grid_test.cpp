// The spatial grid of rotary axes: twists by hand, and against the error of every pose.

#include "volcal/identify/errors/rotary/rotary_grid.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "tests/support/rotary_machines.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using testing::GivenErrors;
using testing::result_with;

constexpr double kGridStep = 30.0 * kRadianPerDegree;

std::vector<RotaryGrid> grids_of(const FitResult& result, const RotaryShares& shares = {}) {
  return rotary_grids(result, default_conditions(result), kGridStep, shares);
}

/// An axis line of a table that lies 10 um towards x, or leans by 100 urad about x, takes the table with it:
/// the tool is 10 um towards -x of it, wherever C stands.
TEST(RotaryGrid, HoldsLocationErrorsOfATableInMachineDirections) {
  const Machine machine = testing::rotary_machine("w C' b X Y Z t");
  const FitResult result = result_with(machine, {.locations = {{"EA0C", 100e-6}, {"EX0C", 10e-6}}}, 4);
  const auto grids = grids_of(result);
  ASSERT_EQ(grids.size(), 1U);
  EXPECT_EQ(grids[0].body, TurnedBody::Table);
  EXPECT_EQ(grids[0].reference, machine.axis(AxisName::C).centre);
  ASSERT_EQ(grids[0].axes.size(), 1U);
  EXPECT_TRUE(grids[0].axes[0].full_turn);
  EXPECT_EQ(grids[0].twists.size(), 13U);
  for (const RotaryTwist& twist : grids[0].twists) {
    EXPECT_LT((twist.value.head<3>() - Vector3d(-10e-6, 0, 0)).norm(), 1e-15);
    EXPECT_LT((twist.value.tail<3>() - Vector3d(-100e-6, 0, 0)).norm(), 1e-15);
  }
}

/// Error motions are relative and in the stator: the same numbers at every angle, on both sides of the bed.
TEST(RotaryGrid, HoldsErrorMotionsInTheStator) {
  for (const char* structure : {"w C' b X Y Z t", "w b X Y Z C t"}) {
    const Machine machine = testing::rotary_machine(structure);
    const FitResult result = result_with(
        machine, {.functions = {{"EBC", [](double) { return 20e-6; }}, {"EYC", [](double) { return 3e-6; }}}},
        4);
    const auto grids = grids_of(result);
    ASSERT_EQ(grids.size(), 1U);
    for (const RotaryTwist& twist : grids[0].twists) {
      EXPECT_LT((twist.value.head<3>() - Vector3d(0, 3e-6, 0)).norm(), 1e-15) << structure;
      EXPECT_LT((twist.value.tail<3>() - Vector3d(0, 20e-6, 0)).norm(), 1e-15) << structure;
    }
  }
}

/// On a trunnion at A = -90 deg the axis of C lies along -y ... +y: by hand, C's zero position of 100 urad is
/// a rotation of the tool about +y at the reference point, no displacement.
TEST(RotaryGrid, TurnsTheErrorsOfTheInnerAxisWithTheCradle) {
  Machine machine = testing::rotary_machine(testing::kTrunnion);
  for (Axis& axis : machine.axes) axis.centre.setZero();
  const FitResult result = result_with(machine, {.locations = {{"EC0C", 100e-6}, {"EX0A", 0.0}}}, 4);
  const auto grids = grids_of(result);
  ASSERT_EQ(grids.size(), 1U);
  const auto positions = grids[0].positions();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double a = positions[i][3];
    // Motion of the table is R_A^-1 on points, so directions in it come back by R_A^-1: z turns to
    // (0, sin a, cos a).
    const Vector3d expected(0, 100e-6 * std::sin(a), 100e-6 * std::cos(a));
    EXPECT_LT((grids[0].twists[i].value.tail<3>() - expected).norm(), 1e-14) << a;
    EXPECT_LT(grids[0].twists[i].value.head<3>().norm(), 1e-15);
  }
}

class GridOf : public ::testing::TestWithParam<const char*> {};

/// At its nodes the twists give the first-order error of every tool at every position of the linear axes.
TEST_P(GridOf, GivesTheErrorOfEveryPoseAtItsNodes) {
  const FitResult result = testing::rotary_result(GetParam());
  const KinematicChain chain(result.machine);
  std::mt19937_64 random(3);
  for (const RotaryGrid& grid : grids_of(result)) {
    const auto positions = grid.positions();
    for (std::size_t i = 0; i < positions.size(); i += 7) {
      AxisPosition position = positions[i];
      for (std::size_t k = 0; k < 3; ++k) position[k] = testing_support::uniform(random, 0.3);
      const Tool tool{"any", testing_support::random_vector(random, 0.2), 0.0};
      FitResult of_side = result;
      for (const FunctionGroup& group : result.layout.groups) {
        if (std::ranges::find(grid.axes, group.axis, &RotaryNodes::axis) == grid.axes.end())
          of_side.parameters.segment(group.offset, group.size()).setZero();
      }
      for (const ParameterBlock& block : result.layout.blocks) {
        if (std::ranges::find(grid.axes, block.location->axis, &RotaryNodes::axis) == grid.axes.end())
          of_side.parameters[block.offset] = 0.0;
      }
      const PoseErrorVector expected = ErrorField(of_side, tool).at(position);
      JointLever levers[kAxisCount];
      chain.levers(position, tool.offset, levers);
      const JointLever* carrier = nullptr;
      for (std::size_t j = 0; j < chain.joint_count(); ++j) {
        if (std::ranges::find(grid.axes, levers[j].axis, &RotaryNodes::axis) == grid.axes.end()) continue;
        if (carrier == nullptr || levers[j].workpiece_side) carrier = &levers[j];
      }
      ASSERT_NE(carrier, nullptr);
      const Vector3d arm = carrier->arm_s + result.machine.axis(carrier->axis).centre - grid.reference;
      const PoseErrorVector& twist = grid.twists[i].value;
      const Vector3d displacement =
          carrier->rotation_ws * (twist.head<3>() + Vector3d(twist.tail<3>()).cross(arm));
      EXPECT_LT((displacement - expected.head<3>()).norm(), 1e-15) << GetParam() << " node " << i;
      EXPECT_LT((carrier->rotation_ws * twist.tail<3>() - expected.tail<3>()).norm(), 1e-15);
      EXPECT_GT(grid.twists[i].u.minCoeff(), 0.6e-6);
    }
  }
}

TEST_P(GridOf, IsTheSumOfItsShares) {
  const FitResult result = testing::rotary_result(GetParam());
  const auto all = grids_of(result), own = grids_of(result, {true, false, false}),
             location = grids_of(result, {false, true, false}),
             motion = grids_of(result, {false, false, true});
  for (std::size_t g = 0; g < all.size(); ++g) {
    for (std::size_t i = 0; i < all[g].twists.size(); ++i)
      EXPECT_LT((all[g].twists[i].value - own[g].twists[i].value - location[g].twists[i].value -
                 motion[g].twists[i].value)
                    .norm(),
                1e-16);
  }
}

INSTANTIATE_TEST_SUITE_P(Structures, GridOf,
                         ::testing::Values(testing::kTrunnion, testing::kHead, testing::kMixed),
                         [](const auto& tested) {
                           return std::string(tested.param == testing::kTrunnion ? "Trunnion"
                                              : tested.param == testing::kHead   ? "Head"
                                                                                 : "Mixed");
                         });

TEST(RotaryGrid, HasOneForEverySideOfTheBed) {
  const auto mixed = grids_of(testing::rotary_result(testing::kMixed));
  ASSERT_EQ(mixed.size(), 2U);
  EXPECT_EQ(mixed[0].body, TurnedBody::Table);
  EXPECT_EQ(mixed[1].body, TurnedBody::Tool);
  const auto head = grids_of(testing::rotary_result(testing::kHead));
  ASSERT_EQ(head.size(), 1U);
  EXPECT_EQ(head[0].reference, testing::rotary_machine(testing::kHead).axis(AxisName::B).centre);
  EXPECT_EQ(head[0].axes[0].axis, AxisName::B);
  EXPECT_EQ(head[0].axes[1].axis, AxisName::C);
}

TEST(RotaryGrid, ALinearAxisBetweenRotaryOnesOfASideIsRefused) {
  const FitResult result = testing::rotary_result("w C' Y' A' b X Z t");
  EXPECT_NE(no_rotary_grid(result), "");
  EXPECT_THROW(grids_of(result), InputError);
}

TEST(RotaryNodes, CoverATurnOrTheTravelInEqualSteps) {
  const Machine machine = testing::rotary_machine(testing::kTrunnion);
  const auto wave = [](double q) { return 5e-6 * std::sin(q); };
  const auto ramp = [](double q) { return 5e-6 * q; };
  const RotaryNodes turn =
      rotary_nodes(result_with(machine, {.functions = {{"ECC", wave}}}, 36), AxisName::C, kGridStep);
  EXPECT_TRUE(turn.full_turn);
  EXPECT_EQ(turn.positions.size(), 13U);
  EXPECT_DOUBLE_EQ(turn.positions.back() - turn.positions.front(), 2.0 * std::numbers::pi);
  const RotaryNodes not_periodic =
      rotary_nodes(result_with(machine, {.functions = {{"ECC", ramp}}}, 36), AxisName::C, kGridStep);
  EXPECT_FALSE(not_periodic.full_turn);
  const RotaryNodes tilt =
      rotary_nodes(result_with(machine, {.functions = {{"EAA", wave}}}, 36), AxisName::A, kGridStep);
  EXPECT_FALSE(tilt.full_turn);
  EXPECT_EQ(tilt.positions.size(), 9U);  // 220 degrees in 8 steps of 27.5
  EXPECT_DOUBLE_EQ(tilt.positions.front(), -110.0 * kRadianPerDegree);
  EXPECT_DOUBLE_EQ(tilt.positions.back(), 110.0 * kRadianPerDegree);
}

}  // namespace
}  // namespace volcal
