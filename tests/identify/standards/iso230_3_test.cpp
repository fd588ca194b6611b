// Drift at rest by hand.

#include "volcal/identify/standards/iso230_3.h"

#include <gtest/gtest.h>

#include <vector>

namespace volcal {
namespace {

/// Every half hour, um: 0, 4, 5, 12, 11, 9. Range 12 over 2.5 hours; 5 in the first hour; in any hour at most
/// 4 to 12 = 8 (0.5 to 1.5 h); change 9.
TEST(Drift, ByHand) {
  const double um[] = {0.0, 4.0, 5.0, 12.0, 11.0, 9.0};
  std::vector<DriftReading> readings;
  for (int k = 5; k >= 0; --k) readings.push_back({1000.0 + 1800.0 * k, um[k] * 1e-6});
  const DriftFigures figures = drift_figures(readings);
  EXPECT_DOUBLE_EQ(figures.duration, 9000.0);
  EXPECT_NEAR(*figures.range, 12e-6, 1e-18);
  EXPECT_NEAR(*figures.first_hour, 5e-6, 1e-18);
  EXPECT_NEAR(*figures.fastest_in_an_hour, 8e-6, 1e-18);
  EXPECT_NEAR(*figures.change, 9e-6, 1e-18);
}

TEST(Drift, OfLessThanAnHourHasNoHourlyFigures) {
  const std::vector<DriftReading> readings = {{0.0, 1e-6}, {600.0, -2e-6}};
  const DriftFigures figures = drift_figures(readings);
  EXPECT_NEAR(*figures.range, 3e-6, 1e-18);
  EXPECT_NEAR(*figures.change, -3e-6, 1e-18);
  EXPECT_FALSE(figures.first_hour);
  EXPECT_FALSE(figures.fastest_in_an_hour);
  EXPECT_FALSE(drift_figures({}).range);
}

}  // namespace
}  // namespace volcal
