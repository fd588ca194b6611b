#include "volcal/identify/standards/approach.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/machines.h"

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

Machine machine() {
  Machine machine = testing_support::machine_of("w C' b X Y Z A t");
  machine.axes.back().endless = false;
  return machine;
}

Readings two_passes() {
  Readings readings;
  readings.position[0] = {0.0, 0.1, 0.1, 0.0};
  readings.line = {7, 7, 8, 8};
  readings.source_line = {2, 3, 4, 5};
  return readings;
}

TEST(AxisApproach, OrderCountsWithinEachPass) {
  EXPECT_THAT(axis_approach(machine(), two_passes(), AxisName::X), ElementsAre(1, 1, -1, -1));
}

TEST(AxisApproach, ColumnGoesBeforeOrderWhereItSaysSomething) {
  Readings readings = two_passes();
  readings.direction[0] = {-1, 0, 0, -1};
  EXPECT_THAT(axis_approach(machine(), readings, AxisName::X), ElementsAre(-1, 1, -1, -1));
}

TEST(AxisApproach, AxisThatTheMachineLacksIsUnknown) {
  EXPECT_THAT(axis_approach(machine(), two_passes(), AxisName::Y), ElementsAre(0, 0, 0, 0));
}

/// One pass in degrees.
Readings turned(AxisName axis, const std::vector<double>& degrees) {
  Readings readings;
  for (const double angle : degrees)
    readings.position[index_of(axis)].push_back(angle * std::numbers::pi / 180.0);
  readings.source_line.assign(degrees.size(), 2);
  return readings;
}

std::vector<int> approach_of(AxisName axis, const std::vector<double>& degrees) {
  return axis_approach(machine(), turned(axis, degrees), axis);
}

/// There over 0 and back, as a control records it that counts within a turn.
TEST(AxisApproach, GoesOnOverTheEndOfATurn) {
  EXPECT_THAT(approach_of(AxisName::C, {240, 300, 0, 60, 60, 0, 300, 240}),
              ElementsAre(1, 1, 1, 1, -1, -1, -1, -1));
  EXPECT_THAT(approach_of(AxisName::C, {120, 170, -140, -90, -140, 170}), ElementsAre(1, 1, 1, 1, -1, -1));
}

TEST(AxisApproach, StandsAtTheEndOfATurnWhatEverScatterIsRecorded) {
  EXPECT_THAT(approach_of(AxisName::C, {0.0001, 359.9999, 0.0001}), ElementsAre(0, 0, 0));
}

/// Turns that are counted on, and axes with ends, move as recorded.
TEST(AxisApproach, IsAsRecordedWhereTurnsAreCounted) {
  EXPECT_THAT(approach_of(AxisName::C, {0, 200, 400, 600, 400, 200}), ElementsAre(1, 1, 1, 1, -1, -1));
  EXPECT_THAT(approach_of(AxisName::A, {-170, 170, -170}), ElementsAre(1, 1, -1));
}

TEST(AxisApproach, OfHalfATurnIsUnknown) {
  EXPECT_THAT(approach_of(AxisName::C, {0, 60, 240, 300, 240}), ElementsAre(1, 1, 0, 1, -1));
  EXPECT_THAT(approach_of(AxisName::C, {0, 180, 0}), ElementsAre(0, 0, 0));
  EXPECT_EQ(readings_after_half_turns(machine(), turned(AxisName::C, {0, 60, 240, 300, 120}), AxisName::C),
            2U);
  EXPECT_EQ(readings_after_half_turns(machine(), turned(AxisName::A, {0, 60, 240}), AxisName::A), 0U);
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
