// Where axis lines lie at machine zero, and constant error motions against location errors; by hand.

#include "volcal/identify/errors/rotary/rotary_axes.h"

#include <gtest/gtest.h>

#include "tests/support/rotary_machines.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using testing_support::error_of;

/// p_C = 0, p_A = (0, 0, 50) mm: alpha = (30, -20 + 60, -40) urad less what is about the axes themselves,
/// d = (5, 7) + (0, 10) + (60e-6 * -50e3, 0) = (2, 17) um.
TEST(AxisLines, ComposeAtMachineZero) {
  Machine machine = testing_support::machine_of("w C' A' b X Y Z t");
  machine.axes[1].centre = {0.0, 0.0, 0.05};
  PoseErrors<double> errors;
  error_of(errors, "EY0A") = 10e-6;
  error_of(errors, "EZ0A") = -20e-6;
  error_of(errors, "EB0A") = 60e-6;
  error_of(errors, "EC0A") = -40e-6;
  error_of(errors, "EX0C") = 5e-6;
  error_of(errors, "EY0C") = 7e-6;
  error_of(errors, "EA0C") = 30e-6;
  error_of(errors, "EB0C") = -20e-6;
  const AxisLineErrors c = line_at_machine_zero(machine, errors, AxisName::C);
  EXPECT_LT((c.displacement.head<2>() - Eigen::Vector2d(2e-6, 17e-6)).norm(), 1e-15);
  EXPECT_LT((c.rotation.head<2>() - Eigen::Vector2d(30e-6, 40e-6)).norm(), 1e-15);
  const AxisLineErrors a = line_at_machine_zero(machine, errors, AxisName::A);
  EXPECT_LT((a.displacement - Vector3d(0, 10e-6, -20e-6)).norm(), 1e-15);
  EXPECT_LT((a.rotation - Vector3d(0, 60e-6, -40e-6)).norm(), 1e-15);
}

/// p_C = 0, p_B = (0, 0, -80) mm; EA0C = 50 urad carries B's line by 50e-6 x 80 mm = 4 um along y. The table
/// axis X' carries neither.
TEST(AxisLines, OfAHeadAreCarriedByTheAxisNearerTheBed) {
  Machine machine = testing_support::machine_of("w X' b Y Z C B t");
  machine.axes.back().centre = {0.0, 0.0, -0.08};
  PoseErrors<double> errors;
  error_of(errors, "EA0C") = 50e-6;
  error_of(errors, "EX0B") = 3e-6;
  const AxisLineErrors b = line_at_machine_zero(machine, errors, AxisName::B);
  EXPECT_LT((b.displacement - Vector3d(3e-6, 4e-6, 0)).norm(), 1e-15);
  EXPECT_LT((b.rotation - Vector3d(50e-6, 0, 0)).norm(), 1e-15);
  EXPECT_LT(line_at_machine_zero(machine, errors, AxisName::C).displacement.norm(), 1e-15);
}

/// EXC = c is EX0C = s c, s = -1 on the workpiece side; of rotations about the axis itself s = 1.
TEST(AxisLines, AConstantErrorMotionIsALocationError) {
  std::mt19937_64 random(5);
  for (const char* structure : {testing::kTrunnion, testing::kHead, testing::kMixed}) {
    const Machine machine = testing::rotary_machine(structure);
    const KinematicChain chain(machine);
    for (const Axis& axis : machine.axes) {
      if (!is_rotary(axis.name)) continue;
      const auto joint = std::ranges::find(machine.structure.joints, axis.name, &Joint::axis);
      for (const Component component : kAllComponents) {
        const ErrorSymbol symbol{component, axis.name};
        const bool own = symbol.is_positioning();
        const double sign = joint->workpiece_side && !own ? -1.0 : 1.0;
        PoseErrors<double> motion, location;
        motion.motion[index_of(axis.name)][index_of(component)] = 10e-6;
        location.location[index_of(axis.name)][index_of(component)] = sign * 10e-6;
        const AxisPosition position = testing_support::random_position(random);
        const Vector3d tool(0.03, -0.02, -0.2);
        const ToolTwist by_motion = chain.first_order(position, tool, motion);
        const ToolTwist by_location = chain.first_order(position, tool, location);
        EXPECT_LT((by_motion.displacement_w - by_location.displacement_w).norm(), 1e-18) << symbol.name();
        EXPECT_LT((chain.exact_pose<double>(position, tool, motion).point_w -
                   chain.exact_pose<double>(position, tool, location).point_w)
                      .norm(),
                  1e-15)
            << symbol.name();
      }
    }
  }
}

TEST(IdentifiedRotaryAxes, AreThoseWithFunctionsOrLocations) {
  const Machine machine = testing::rotary_machine(testing::kTrunnion);
  const auto axes_of = [&](const testing::GivenErrors& given) {
    return identified_rotary_axes(testing::result_with(machine, given, 4));
  };
  EXPECT_TRUE(axes_of({.functions = {{"EXX", [](double) { return 0.0; }}}}).empty());
  EXPECT_EQ(axes_of({.functions = {{"ECC", [](double) { return 0.0; }}}, .locations = {{"EY0A", 1e-6}}}),
            (std::vector<AxisName>{AxisName::A, AxisName::C}));
}

}  // namespace
}  // namespace volcal
