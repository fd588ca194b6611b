/// What a station sees, by hand.

#include "volcal/identify/planning/line_of_sight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "volcal/sim/machine/reference_machines.h"

namespace volcal {
namespace {

/// 1000 x 600 x 500 mm, the tool 150 mm below the spindle's reference point.
PlanSettings one_short_tool() {
  PlanSettings settings;
  settings.machine = sim::reference_machines().front();
  settings.machine.tools.resize(1);
  settings.budget.readings = 100;
  return settings;
}

TEST(LineOfSight, DistanceFromAHalfLine) {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ(), foot(0.0, 0.0, 1.0);
  const auto distance = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return distance_from_half_line(a, b, foot, up);
  };
  EXPECT_NEAR(distance({-1.0, 0.2, 2.0}, {1.0, 0.2, 2.0}), 0.2, 1e-9);  // passes beside it
  EXPECT_NEAR(distance({-1.0, 0.0, 0.4}, {1.0, 0.0, 0.4}), 0.6, 1e-9);  // passes below its foot
  EXPECT_NEAR(distance({0.3, 0.4, 5.0}, {3.0, 4.0, 5.0}), 0.5, 1e-9);   // ends before it
}

TEST(LineOfSight, KeepsToRangeAndElevation) {
  const PlanSettings settings = one_short_tool();
  const LineOfSight sight(settings);
  const AxisPosition origin{};  // functional point at (0, 0, -150) mm
  EXPECT_TRUE(sight.sees({-0.5, 0.0, -0.15}, origin, 0));
  EXPECT_FALSE(sight.sees({-0.1, 0.0, -0.15}, origin, 0));   // 100 mm away, 200 mm at least
  EXPECT_FALSE(sight.sees({-16.0, 0.0, -0.15}, origin, 0));  // 15 m at most
  EXPECT_FALSE(sight.sees({0.0, 0.0, -1.0}, origin, 0));     // straight up, 85 degrees at most
  EXPECT_FALSE(sight.sees({-0.3, 0.0, 0.2}, origin, 0));     // 49 degrees down, 35 at most
}

/// From the height of the spindle's reference point, 150 mm above the reflector, a beam from 20 mm aside
/// passes through the spindle of 100 mm radius.
TEST(LineOfSight, IsEndedByTheSpindle) {
  PlanSettings settings = one_short_tool();
  settings.limits.elevation_min = -1.5;
  EXPECT_FALSE(LineOfSight(settings).sees({-0.25, 0.0, 1.0}, AxisPosition{}, 0));
  settings.surroundings.spindle_radius = 0.0;
  EXPECT_TRUE(LineOfSight(settings).sees({-0.25, 0.0, 1.0}, AxisPosition{}, 0));
}

TEST(LineOfSight, StationsStandOutsideWhatToolsAndSpindleSweep) {
  const PlanSettings settings = one_short_tool();
  const LineOfSight sight(settings);
  EXPECT_TRUE(sight.swept_w().min().isApprox(Eigen::Vector3d(0.0, 0.0, -0.15)));
  EXPECT_TRUE(sight.swept_w().max().isApprox(Eigen::Vector3d(1.0, 0.6, 0.35)));
  EXPECT_EQ(sight.spindle_w(), Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(sight.can_stand({-0.2, -0.1, -0.1}));
  EXPECT_FALSE(sight.can_stand({0.5, 0.3, 0.0}));    // inside
  EXPECT_FALSE(sight.can_stand({-0.05, 0.3, 0.0}));  // nearer than 100 mm
  EXPECT_FALSE(sight.can_stand({-0.2, 0.3, 0.3}));   // above the middle of the volume
  EXPECT_FALSE(sight.can_stand({-0.4, 0.3, 0.0}));   // beyond 30 % of the travel
}

}  // namespace
}  // namespace volcal
