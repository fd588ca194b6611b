// Where lines are sampled: shares without a period, weights that integrate, the quartic through five values.

#include "volcal/identify/program/sample_shares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "volcal/identify/program/quartic.h"

namespace volcal {
namespace {

TEST(SampleShares, LeaveNoGap) {
  for (const std::size_t count : {1U, 2U, 5U, 13U, 100U, 1000U}) {
    std::vector<double> ends = {0.0, 1.0};
    for (std::size_t i = 0; i < count; ++i) ends.push_back(sample_share(i));
    std::ranges::sort(ends);
    for (std::size_t i = 0; i + 1 < ends.size(); ++i)
      EXPECT_LT(ends[i + 1] - ends[i], 2.0 / static_cast<double>(count)) << count;
  }
}

/// The integral of x^5 over a line of length 1 is 1/6, exactly by three Gauss points; that of sin^2 of a wave
/// is 1/2 though its period divides the line.
TEST(SampleShares, IntegrateByTheirWeights) {
  for (const std::size_t parts : {1U, 7U, 200U}) {
    std::vector<WeightedShare> shares;
    weighted_shares(parts, shares);
    double sum = 0.0, fifth = 0.0;
    for (const auto& [share, weight] : shares) {
      sum += weight;
      fifth += weight * std::pow(share, 5);
    }
    EXPECT_NEAR(sum, 1.0, 1e-12) << parts;
    EXPECT_NEAR(fifth, 1.0 / 6.0, 1e-12) << parts;
  }
  std::vector<WeightedShare> shares;
  weighted_shares(200, shares);
  for (const double waves : {100.0, 200.0, 300.0, 600.0}) {
    double square = 0.0;
    for (const auto& [share, weight] : shares)
      square += weight * std::pow(std::sin(2.0 * std::numbers::pi * waves * share), 2);
    EXPECT_NEAR(square, 0.5, 0.1) << waves;
  }
}

TEST(SampleShares, PartsAreAboutAMillimetre) {
  EXPECT_EQ(parts_of_length(0.0), 1U);
  EXPECT_EQ(parts_of_length(0.0101), 11U);
  EXPECT_EQ(parts_of_length(1e6), 100000U);
}

TEST(Quartic, IsThePolynomialThroughItsNodes) {
  const auto polynomial = [](double x) { return 1.0 - 2.0 * x + 3.0 * x * x * x - 5.0 * x * x * x * x; };
  for (const double share : {0.0, 0.1, 0.25, 0.618, 1.0}) {
    const auto weights = quartic_weights(share);
    double value = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      value += weights[i] * polynomial(kQuarticNodes[i]);
      sum += weights[i];
    }
    EXPECT_NEAR(value, polynomial(share), 1e-12) << share;
    EXPECT_NEAR(sum, 1.0, 1e-12) << share;
  }
}

}  // namespace
}  // namespace volcal
