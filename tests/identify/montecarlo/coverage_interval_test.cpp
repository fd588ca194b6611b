// Intervals, tolerances and sums against GUM Supplement 1 (JCGM 101:2008) and hand calculations.

#include "volcal/identify/montecarlo/coverage_interval.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <vector>

#include "volcal/identify/montecarlo/counter_random.h"
#include "volcal/identify/montecarlo/draw_sums.h"

namespace volcal {
namespace {

// 7.9.2: u = 0.000 35 g to two digits is 35 x 10^-5 g, to one 4 x 10^-4 g; u = 2 K to one digit.
TEST(NumericalTolerance, IsThatOfTheExamplesOfTheSupplement) {
  EXPECT_NEAR(numerical_tolerance(0.00035, 2), 0.5e-5, 1e-12);
  EXPECT_NEAR(numerical_tolerance(0.00035, 1), 0.5e-4, 1e-12);
  EXPECT_NEAR(numerical_tolerance(2.0, 1), 0.5, 1e-12);
}

// 0.997 to two digits is 1.0, ten of 10^-1.
TEST(NumericalTolerance, FollowsAnUncertaintyThatRoundsUp) {
  EXPECT_NEAR(numerical_tolerance(0.997, 2), 0.05, 1e-12);
  EXPECT_NEAR(numerical_tolerance(0.994, 2), 0.005, 1e-12);
}

// Bins 0..1, 1..2, 2..3 with 1, 2 and 1 counts: half lies below 1.5, a quarter below 1, 7/8 below 2.5.
TEST(HistogramView, QuantilesAreLinearWithinABin) {
  const std::vector<std::uint32_t> counts = {1, 2, 1};
  const HistogramView histogram{counts, 0.0, 1.0, 4};
  EXPECT_NEAR(histogram.quantile(0.5), 1.5, 1e-15);
  EXPECT_NEAR(histogram.quantile(0.25), 1.0, 1e-15);
  EXPECT_NEAR(histogram.quantile(0.875), 2.5, 1e-15);
  const CoverageInterval interval = symmetric_interval(histogram, 0.5);
  EXPECT_NEAR(interval.low, 1.0, 1e-15);
  EXPECT_NEAR(interval.high, 2.0, 1e-15);
}

// Counts 8 4 2 1 1 over five bins: the shortest interval with 3/4 of 16 is [0, 2]; the symmetric one reaches
// from 2/8 into the first bin to the end of the third.
TEST(ShortestInterval, LeansToWhereTheDensityIsHigh) {
  const std::vector<std::uint32_t> counts = {8, 4, 2, 1, 1};
  const HistogramView histogram{counts, 0.0, 1.0, 16};
  const CoverageInterval shortest = shortest_interval(histogram, 0.75);
  EXPECT_NEAR(shortest.low, 0.0, 1e-15);
  EXPECT_NEAR(shortest.high, 2.0, 1e-15);
  const CoverageInterval symmetric = symmetric_interval(histogram, 0.75);
  EXPECT_NEAR(symmetric.low, 0.25, 1e-15);
  EXPECT_NEAR(symmetric.high, 3.0, 1e-15);
}

/// Sum of four independent quantities of expectation 0 (9.2), 10^6 draws in blocks of 10^4.
StudySums additive(const std::vector<double>& rectangular_u, std::size_t normals, double unit) {
  constexpr Eigen::Index kBlock = 10000;
  StudySums sums(1);
  for (std::uint64_t block = 0; block < 100; ++block) {
    Eigen::ArrayXXd t = Eigen::ArrayXXd::Zero(kBlock, 1);
    for (Eigen::Index k = 0; k < kBlock; ++k) {
      const std::uint64_t draw = block * kBlock + static_cast<std::uint64_t>(k);
      std::vector<double> normal(normals), uniform(rectangular_u.size());
      CounterRandom(11, draw, RandomSource::Readings).normals(normal);
      CounterRandom(11, draw, RandomSource::Disturbances).uniforms(uniform);
      for (const double value : normal) t(k, 0) += value;
      for (std::size_t i = 0; i < uniform.size(); ++i)
        t(k, 0) += rectangular_u[i] * std::numbers::sqrt3 * (2.0 * uniform[i] - 1.0);
    }
    t /= unit;
    Histograms counts(1);
    counts.add(t);
    sums.add(Moments::of(t), counts);
  }
  return sums;
}

// 9.2.2: four normal inputs, u = 2.00, interval +-3.92.
TEST(AdditiveModelOfTheSupplement, NormalInputs) {
  const StudySums sums = additive({}, 4, 2.0);
  EXPECT_EQ(sums.draws(), 1000000U);
  EXPECT_EQ(sums.sequences(), 100U);
  EXPECT_NEAR(2.0 * sums.mean(0), 0.0, 4.0 * 0.002);
  EXPECT_NEAR(2.0 * sums.deviation(0), 2.0, 0.006);
  const CoverageInterval interval = symmetric_interval(sums.histogram(0), 0.95);
  EXPECT_NEAR(2.0 * interval.low, -3.92, 0.02);
  EXPECT_NEAR(2.0 * interval.high, 3.92, 0.02);
}

// 9.2.3: four rectangular inputs of u = 1: u = 2.00, interval +-3.88, and the linear +-3.92 stands (0.04 <
// 0.05).
TEST(AdditiveModelOfTheSupplement, RectangularInputsOfOneWidth) {
  const StudySums sums = additive({1.0, 1.0, 1.0, 1.0}, 0, 2.0);
  EXPECT_NEAR(2.0 * sums.deviation(0), 2.0, 0.006);
  const CoverageInterval interval = symmetric_interval(sums.histogram(0), 0.95);
  EXPECT_NEAR(2.0 * interval.low, -3.88, 0.015);
  EXPECT_NEAR(2.0 * interval.high, 3.88, 0.015);
  EXPECT_LT(std::abs(2.0 * interval.high - 3.92), numerical_tolerance(2.0, 2));
}

// 9.2.4: one of them with u = 10: u = 10.1, interval +-17.0, where linear propagation says +-19.9.
TEST(AdditiveModelOfTheSupplement, OneWideRectangularInput) {
  const double u = std::sqrt(103.0);
  const StudySums sums = additive({1.0, 1.0, 1.0, 10.0}, 0, u);
  EXPECT_NEAR(u * sums.deviation(0), 10.1, 0.06);
  const CoverageInterval symmetric = symmetric_interval(sums.histogram(0), 0.95);
  EXPECT_NEAR(u * symmetric.low, -17.0, 0.06);
  EXPECT_NEAR(u * symmetric.high, 17.0, 0.06);
  const CoverageInterval shortest = shortest_interval(sums.histogram(0), 0.95);
  EXPECT_NEAR(u * (shortest.high - shortest.low), 34.0, 0.12);
  EXPECT_GT(std::abs(u * symmetric.high - 19.9), numerical_tolerance(u, 2));
}

// A mean of n normal draws has the standard error 1 / sqrt(n); that of 100 sequences is known to 7 %.
TEST(StudySums, StandardErrorsComeFromTheScatterOverSequences) {
  const StudySums sums = additive({}, 1, 1.0);
  EXPECT_NEAR(sums.standard_error(0, Figure::Mean) * 1000.0, 1.0, 0.28);
  EXPECT_NEAR(sums.standard_error(0, Figure::Deviation) * 1000.0, std::sqrt(0.5), 0.2);
  EXPECT_NEAR(sums.standard_error(0, Figure::High) * 1000.0, 2.67, 0.8);
  EXPECT_TRUE(std::isinf(StudySums(1).standard_error(0, Figure::Mean)));
}

TEST(Histograms, OuterBinsTakeWhatLiesBeyond) {
  Histograms counts(1);
  Eigen::ArrayXXd t(4, 1);
  t << -1e9, 1e9, -8.0, 7.9999;
  counts.add(t);
  EXPECT_EQ(counts.counts().front(), 2U);
  EXPECT_EQ(counts.counts().back(), 2U);
}

}  // namespace
}  // namespace volcal
