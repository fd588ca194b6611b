#include "volcal/identify/standards/approach.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace volcal {
namespace {

using ::testing::ElementsAre;

TEST(ApproachFromOrder, ThereAndBack) {
  EXPECT_THAT(approach_from_order(std::vector<double>{0.0, 0.1, 0.2, 0.1, 0.0}),
              ElementsAre(1, 1, 1, -1, -1));
}

/// At the turning point 0.2 is read twice, the axis overrunning it in between: once from each side.
TEST(ApproachFromOrder, RepeatedEndPointBelongsToTheNextMove) {
  EXPECT_THAT(approach_from_order(std::vector<double>{0.0, 0.2, 0.2, 0.0}), ElementsAre(1, 1, -1, -1));
}

TEST(ApproachFromOrder, RestsAtTheEndKeepTheLastMove) {
  EXPECT_THAT(approach_from_order(std::vector<double>{0.0, 0.2, 0.2}), ElementsAre(1, 1, 1));
  EXPECT_THAT(approach_from_order(std::vector<double>{0.3, 0.3}), ElementsAre(0, 0));
  EXPECT_TRUE(approach_from_order({}).empty());
}

Readings two_passes() {
  Readings readings;
  readings.position[0] = {0.0, 0.1, 0.1, 0.0};
  readings.line = {7, 7, 8, 8};
  readings.source_line = {2, 3, 4, 5};
  return readings;
}

TEST(AxisApproach, OrderCountsWithinEachPass) {
  EXPECT_THAT(axis_approach(two_passes(), AxisName::X), ElementsAre(1, 1, -1, -1));
}

TEST(AxisApproach, ColumnGoesBeforeOrderWhereItSaysSomething) {
  Readings readings = two_passes();
  readings.direction[0] = {-1, 0, 0, -1};
  EXPECT_THAT(axis_approach(readings, AxisName::X), ElementsAre(-1, 1, -1, -1));
}

TEST(AxisApproach, AxisThatTheMachineLacksIsUnknown) {
  EXPECT_THAT(axis_approach(two_passes(), AxisName::Y), ElementsAre(0, 0, 0, 0));
}

TEST(Passes, KeepTheOrderOfFirstAppearance) {
  Readings readings = two_passes();
  readings.line = {3, 1, 3, 1};
  const auto found = passes(readings);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].line, 3);
  EXPECT_THAT(found[0].rows, ElementsAre(0, 2));
  EXPECT_THAT(found[1].rows, ElementsAre(1, 3));
}

}  // namespace
}  // namespace volcal
