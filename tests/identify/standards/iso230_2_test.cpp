#include "volcal/identify/standards/iso230_2.h"

#include <gtest/gtest.h>

#include <cmath>

#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kExact = 1e-15;

void add(std::vector<PositioningReading>& readings, double target_mm, int direction,
         std::initializer_list<double> deviations_um) {
  for (const double deviation : deviations_um) {
    readings.push_back({target_mm * 1e-3, deviation * kMicro, direction});
  }
}

void expect_um(const std::optional<double>& value, double expected_um) {
  ASSERT_TRUE(value.has_value());
  EXPECT_NEAR(*value, expected_um * kMicro, kExact);
}

/// Worked by hand, all in um. Three targets, three approaches each:
///
///   target  + readings   mean+  s+   - readings   mean-  s-    B_i = mean+ - mean-   mean of both
///   0 mm     0  1  2      1     1     3  4  5      4     1     -3                    2.5
///   50 mm    4  6  8      6     2     5  5  5      5     0     +1                    5.5
///   100 mm  -2 -2 -2     -2     0    -3  0  3      0     3     -2                   -1
///
/// (s: squares 1 + 0 + 1 = 2, / 2 = 1; 4 + 0 + 4 = 8, / 2 = 4; 9 + 0 + 9 = 18, / 2 = 9.)
/// E+ = 6 - (-2) = 8.  E- = 5 - 0 = 5.  E = 6 - (-2) = 8.  M = 5.5 - (-1) = 6.5.
/// B = 3.  Mean reversal = (-3 + 1 - 2) / 3 = -4/3.
/// R+ = 4 x 2 = 8.  R- = 4 x 3 = 12.
/// R_1 = max(2 + 2 + 3, 4, 4) = 7;  R_2 = max(4 + 0 + 1, 8, 0) = 8;  R_3 = max(0 + 6 + 2, 0, 12) = 12.  R
/// = 12. A+: upper 3, 10, -2; lower -1, 2, -2: 10 - (-2) = 12.  A-: upper 6, 5, 6; lower 2, 5, -6: 6 - (-6)
/// = 12. A = 10 - (-6) = 16.
std::vector<PositioningReading> hand_example() {
  std::vector<PositioningReading> readings;
  add(readings, 0, +1, {0, 1, 2});
  add(readings, 50, +1, {4, 6, 8});
  add(readings, 100, +1, {-2, -2, -2});
  add(readings, 100, -1, {-3, 0, 3});
  add(readings, 50, -1, {5, 5, 5});
  add(readings, 0, -1, {3, 4, 5});
  return readings;
}

TEST(Iso230Part2, HandWorkedExample) {
  const PositioningFigures figures = positioning_figures(hand_example());
  ASSERT_EQ(figures.targets.size(), 3U);
  EXPECT_EQ(figures.targets[0].positive.count, 3);
  EXPECT_NEAR(figures.targets[1].position, 0.05, kExact);
  expect_um(figures.targets[0].positive.deviation_s, 1);
  expect_um(figures.targets[2].negative.deviation_s, 3);
  expect_um(figures.targets[0].repeatability(), 7);
  expect_um(figures.targets[1].repeatability(), 8);
  expect_um(figures.positive.systematic, 8);
  expect_um(figures.negative.systematic, 5);
  expect_um(figures.systematic, 8);
  expect_um(figures.mean_bidirectional, 6.5);
  expect_um(figures.reversal, 3);
  expect_um(figures.mean_reversal, -4.0 / 3.0);
  expect_um(figures.positive.repeatability, 8);
  expect_um(figures.negative.repeatability, 12);
  expect_um(figures.repeatability, 12);
  expect_um(figures.positive.accuracy, 12);
  expect_um(figures.negative.accuracy, 12);
  expect_um(figures.accuracy, 16);
}

TEST(Iso230Part2, OffsetOfTheReadingsChangesNoFigure) {
  auto shifted = hand_example();
  for (auto& reading : shifted) reading.deviation += 123.0 * kMicro;
  const PositioningFigures figures = positioning_figures(shifted);
  expect_um(figures.accuracy, 16);
  expect_um(figures.systematic, 8);
  expect_um(figures.repeatability, 12);
  expect_um(figures.mean_reversal, -4.0 / 3.0);
}

TEST(Iso230Part2, OneApproachLeavesRepeatabilityUndefined) {
  std::vector<PositioningReading> readings;
  add(readings, 0, +1, {1});
  add(readings, 50, +1, {4});
  add(readings, 50, -1, {2});
  add(readings, 0, -1, {0});
  const PositioningFigures figures = positioning_figures(readings);
  EXPECT_FALSE(figures.targets[0].positive.deviation_s.has_value());
  EXPECT_FALSE(figures.positive.repeatability.has_value());
  EXPECT_FALSE(figures.repeatability.has_value());
  EXPECT_FALSE(figures.accuracy.has_value());
  EXPECT_FALSE(figures.negative.accuracy.has_value());
  expect_um(figures.systematic, 4);            // 4 - 0
  expect_um(figures.reversal, 2);              // 4 - 2
  expect_um(figures.mean_reversal, 1.5);       // (1 + 2) / 2
  expect_um(figures.mean_bidirectional, 2.5);  // 3 - 0.5
}

TEST(Iso230Part2, OneTargetWithoutRepetitionLeavesTheAxisFiguresUndefined) {
  auto readings = hand_example();
  add(readings, 150, +1, {0});
  const PositioningFigures figures = positioning_figures(readings);
  EXPECT_FALSE(figures.positive.repeatability.has_value());
  EXPECT_FALSE(figures.accuracy.has_value());
  EXPECT_FALSE(figures.repeatability.has_value());
  expect_um(figures.negative.repeatability, 12);
  expect_um(figures.systematic, 8);
}

TEST(Iso230Part2, OneDirectionGivesNoBidirectionalFigure) {
  std::vector<PositioningReading> readings;
  add(readings, 0, +1, {0, 2});
  add(readings, 50, +1, {5, 5});
  const PositioningFigures figures = positioning_figures(readings);
  expect_um(figures.positive.systematic, 4);                         // 5 - 1
  expect_um(figures.positive.repeatability, 4.0 * std::sqrt(2.0));   // s = sqrt((1 + 1) / 1)
  expect_um(figures.positive.accuracy, 4.0 + 2.0 * std::sqrt(2.0));  // 5 - (1 - 2 sqrt 2)
  EXPECT_FALSE(figures.negative.systematic.has_value());
  EXPECT_FALSE(figures.systematic.has_value());
  EXPECT_FALSE(figures.reversal.has_value());
  EXPECT_FALSE(figures.mean_bidirectional.has_value());
  EXPECT_FALSE(figures.repeatability.has_value());
  EXPECT_FALSE(figures.accuracy.has_value());
}

TEST(Iso230Part2, TargetsWithinAMicrometreAreOne) {
  const std::vector<PositioningReading> readings = {
      {0.1, 1e-6, +1}, {0.1 + 0.9e-6, 3e-6, +1}, {0.1 + 2.1e-6, 5e-6, +1}};
  const PositioningFigures figures = positioning_figures(readings);
  ASSERT_EQ(figures.targets.size(), 2U);
  EXPECT_EQ(figures.targets[0].positive.count, 2);
  EXPECT_EQ(figures.targets[1].positive.count, 1);
}

TEST(Iso230Part2, UnknownApproachesAreCountedAndLeftOut) {
  auto readings = hand_example();
  add(readings, 0, 0, {1000});
  const PositioningFigures figures = positioning_figures(readings);
  EXPECT_EQ(figures.unknown_direction, 1);
  expect_um(figures.accuracy, 16);
}

TEST(Iso230Part2, NoReadingsNoFigures) {
  const PositioningFigures figures = positioning_figures({});
  EXPECT_TRUE(figures.targets.empty());
  EXPECT_FALSE(figures.positive.systematic.has_value());
  EXPECT_FALSE(figures.systematic.has_value());
}

}  // namespace
}  // namespace volcal
