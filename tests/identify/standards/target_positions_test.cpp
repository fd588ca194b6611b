// Recorded positions that were one target.

#include "volcal/identify/standards/target_positions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "volcal/identify/standards/approach.h"
#include "volcal/identify/standards/iso230_2.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;

TEST(TargetPositions, EqualPositionsAreOneTarget) {
  const std::vector<double> positions = {0.2, 0.1, 0.2, 0.1};
  const TargetGroups groups = group_targets(positions, 1e-6);
  EXPECT_THAT(groups.group, ElementsAre(1U, 0U, 1U, 0U));
  EXPECT_THAT(groups.position, ElementsAre(0.1, 0.2));
  EXPECT_EQ(groups.spread, 0.0);
}

TEST(TargetPositions, ScatterOfRecordedPositionsIsOneTarget) {
  const std::vector<double> positions = {0.1, 0.1 + 3e-6, 0.2 - 2e-6, 0.2 + 2.5e-6, 0.1 - 1.5e-6};
  const TargetGroups groups = group_targets(positions, 1e-6);
  EXPECT_THAT(groups.group, ElementsAre(0U, 0U, 1U, 1U, 0U));
  EXPECT_NEAR(groups.spread, 4.5e-6, 1e-12);
  EXPECT_NEAR(groups.position[0], 0.1 + 0.5e-6, 1e-12);
}

/// Steps of 5 um all along are targets, not the scatter of one.
TEST(TargetPositions, FineStepsStayApart) {
  std::vector<double> positions;
  for (int k = 0; k < 50; ++k) positions.push_back(5e-6 * k);
  EXPECT_EQ(group_targets(positions, 1e-6).position.size(), 50U);
}

/// Fine steps at two places far apart: the clusters are wider than any scatter.
TEST(TargetPositions, FineStepsAtSeveralPlacesStayApart) {
  std::vector<double> positions;
  for (const double place : {0.0, 0.5}) {
    for (int k = 0; k < 30; ++k) positions.push_back(place + 5e-6 * k);
  }
  EXPECT_EQ(group_targets(positions, 1e-6).position.size(), 60U);
}

/// The turn at 0.2 is recorded at 0.2 and 0.2 + 2 um: no move towards +, but the beginning of the way back.
TEST(TargetPositions, AScatteredTurnIsNoMove) {
  const std::vector<double> positions = {0.1, 0.15, 0.2, 0.2 + 2e-6, 0.15 - 1.5e-6, 0.1 + 1e-6};
  EXPECT_THAT(approach_from_order(positions), ElementsAre(1, 1, 1, -1, -1, -1));
}

TEST(TargetPositions, ScatteredTargetsGiveTheFiguresOfOne) {
  std::vector<PositioningReading> exact, scattered;
  const double deviation[] = {1e-6, 3e-6, 2e-6};
  for (int run = 0; run < 3; ++run) {
    for (int target = 0; target < 3; ++target) {
      for (const int direction : {+1, -1}) {
        const double value = deviation[run] + target * 1e-6 - direction * 0.5e-6;
        exact.push_back({0.1 * target, value, direction});
        scattered.push_back({0.1 * target + (run - 1) * 1.2e-6, value, direction});
      }
    }
  }
  const PositioningFigures one = positioning_figures(exact), other = positioning_figures(scattered);
  ASSERT_EQ(other.targets.size(), 3U);
  EXPECT_NEAR(*other.systematic, *one.systematic, 1e-12);
  EXPECT_NEAR(*other.repeatability, *one.repeatability, 1e-12);
  EXPECT_NEAR(*other.accuracy, *one.accuracy, 1e-12);
  EXPECT_NEAR(*other.reversal, 1e-6, 1e-12);
  EXPECT_EQ(one.target_spread, 0.0);
  EXPECT_NEAR(other.target_spread, 2.4e-6, 1e-12);
}

}  // namespace
}  // namespace volcal
