// Means, autocorrelation and partial residuals against numbers worked by hand.

#include "volcal/identify/criticism/figures/figure_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "volcal/identify/statistics/even_sample.h"

namespace volcal {
namespace {

Eigen::VectorXd vector_of(std::initializer_list<double> values) {
  Eigen::VectorXd vector(static_cast<Eigen::Index>(values.size()));
  std::ranges::copy(values, vector.begin());
  return vector;
}

/// One sequence of observations of sigma 1.
NoiseData sequence_of(std::vector<double> time, std::vector<std::int32_t> line) {
  NoiseData data;
  const std::size_t count = std::max(time.size(), line.size());
  data.sequences.emplace_back();
  for (std::size_t i = 0; i < count; ++i) data.sequences[0].observation.push_back(i);
  data.sequences[0].time = std::move(time);
  data.sequences[0].line = std::move(line);
  data.sigma.assign(count, 1.0);
  return data;
}

TEST(EvenSample, TakesAllWhenFewAndAsManyAsAskedForWhenMany) {
  EXPECT_EQ(even_sample(3, 5), (std::vector<std::size_t>{0, 1, 2}));
  const auto sample = even_sample(100000, 100);
  ASSERT_EQ(sample.size(), 100U);
  EXPECT_TRUE(std::ranges::is_sorted(sample));
  double mean = 0.0;
  for (const std::size_t i : sample) mean += static_cast<double>(i) / 100.0;
  EXPECT_NEAR(mean, 50000.0, 3.5 * 100000.0 / std::sqrt(12.0 * 100.0));
}

TEST(FigureStatistics, EqualBinsHoldTheEndsAndLeaveOutWhatIsNotANumber) {
  const double nan = std::nan("");
  EXPECT_EQ(equal_bins(vector_of({0.0, 0.9, 1.0, nan, 3.9, 4.0}), 4), (std::vector<int>{0, 0, 1, -1, 3, 3}));
  EXPECT_EQ(equal_bins(vector_of({2.0, 2.0}), 4), (std::vector<int>{0, 0}));
}

/// White 2, correlated drift 3 of 600 s, line 5; times 0, 600, 1200 s given out of order, the first two of
/// one line. Sum of the covariances: 3 x 4 + 9 (3 + 2 (2/e + 1/e^2)) + 25 (2^2 + 1), over 3^2.
TEST(FigureStatistics, VarianceOfAMeanCountsDriftAndLines) {
  const NoiseData data = sequence_of({600.0, 1200.0, 0.0}, {7, 8, 7});
  const NoiseParameters noise{.white = 2.0, .drift = 3.0, .tau = 600.0, .line = 5.0, .per_metre = 0.0};
  const double e = std::exp(-1.0);
  const auto variance = mean_variance(data, std::span(&noise, 1), {0, 0, 0}, 2);
  ASSERT_EQ(variance.size(), 2U);
  EXPECT_NEAR(variance[0], (12.0 + 9.0 * (3.0 + 2.0 * (2.0 * e + e * e)) + 125.0) / 9.0, 1e-12);
  EXPECT_EQ(variance[1], 0.0);
  const auto apart = mean_variance(data, std::span(&noise, 1), {0, 1, 1}, 2);
  EXPECT_NEAR(apart[0], 4.0 + 9.0 + 25.0, 1e-12);
  EXPECT_NEAR(apart[1], (8.0 + 9.0 * (2.0 + 2.0 * e * e) + 50.0) / 4.0, 1e-12);
}

TEST(FigureStatistics, MeansOfBins) {
  const BinnedMean means = binned_mean(vector_of({0.0, 1.0, 5.0, 9.0}), vector_of({2.0, 4.0, 7.0, 100.0}),
                                       {0, 0, 2, -1}, {4.0, 1.0, 9.0});
  EXPECT_EQ(means.centre, (std::vector<double>{0.5, 5.0}));
  EXPECT_EQ(means.mean, (std::vector<double>{3.0, 7.0}));
  EXPECT_EQ(means.noise, (std::vector<double>{2.0, 3.0}));
  EXPECT_EQ(means.count, (std::vector<std::size_t>{2, 1}));
}

/// A displacement of 3 felt by 0.5, -1 and 1 times: the lengths 1.5, -3 and 3 have the mean 0.5, their
/// displacement is 3. Variance (4 (0.25 + 1 + 1) + 25 (1 + 0.25)) / 2.25^2 with white 2 and lines of 5.
TEST(FigureStatistics, DisplacementsComeFromWhatReadingsFeel) {
  const Eigen::VectorXd felt = vector_of({0.5, -1.0, 1.0}), value = vector_of({1.5, -3.0, 3.0});
  const NoiseData data = sequence_of({}, {1, 1, 2});
  const NoiseParameters noise{.white = 2.0, .drift = 0.0, .tau = 600.0, .line = 5.0, .per_metre = 0.0};
  const auto variance = mean_variance(data, std::span(&noise, 1), {0, 0, 0}, 1, felt);
  EXPECT_NEAR(variance[0], (4.0 * 2.25 + 25.0 * (0.25 + 1.0)) / (2.25 * 2.25), 1e-12);
  const BinnedMean means = binned_mean(vector_of({1.0, 2.0, 3.0}), value, {0, 0, 0}, variance, felt);
  EXPECT_EQ(means.mean, (std::vector<double>{3.0}));
  EXPECT_EQ(binned_mean(value, value, {0, 0, 0}, variance, 0.01 * felt).mean.size(), 0U);
}

/// +1, -1, +1 ...: -1 at odd lags, +1 at even ones. Two lines of 20 with an offset of variance 3 beside white
/// noise of variance 1: pairs within a line have 3/4; at lag 1 that is 38 of 39 pairs.
TEST(FigureStatistics, AutocorrelationByHand) {
  std::vector<double> time;
  std::vector<std::int32_t> line;
  Eigen::VectorXd residual(40);
  for (int i = 0; i < 40; ++i) {
    time.push_back(10.0 * i);
    line.push_back(i / 20);
    residual[i] = i % 2 == 0 ? 1.0 : -1.0;
  }
  const NoiseParameters noise{
      .white = 1.0, .drift = 0.0, .tau = 600.0, .line = std::sqrt(3.0), .per_metre = 0.0};
  const Autocorrelation found =
      autocorrelation(sequence_of(time, line), std::span(&noise, 1), 0, residual, Eigen::VectorXd::Ones(40));
  EXPECT_EQ(found.lag, (std::vector<int>{1, 2, 3, 4, 5, 7, 10}));  // 30 pairs are left at a lag of 10
  EXPECT_EQ(found.pairs[0], 39U);
  EXPECT_NEAR(found.gap[1], 20.0, 1e-12);
  EXPECT_NEAR(found.residual[0], -1.0, 1e-12);
  EXPECT_NEAR(found.residual[1], 1.0, 1e-12);
  EXPECT_NEAR(found.expected[0], 0.75 * 38.0 / 39.0, 1e-12);
  EXPECT_NEAR(found.whitened[0], 1.0, 1e-12);
}

/// y = 1, 3, 2, 6 at x = 0 ... 3 with a free mean: slope 7 / 5 = 1.4, u = sigma / sqrt 5. Sigma is 1/2, so
/// whitened values are doubled.
TEST(FigureStatistics, SlopeOfTheAddedVariablePlotIsTheAmplitude) {
  NoiseProblem problem;
  problem.jacobian = Eigen::MatrixXd::Ones(4, 1);
  problem.residual = vector_of({1.0, 3.0, 2.0, 6.0});
  problem.data = sequence_of({0.0, 1.0, 2.0, 3.0}, {});
  problem.data.sigma.assign(4, 0.5);
  const NoiseParameters noise;
  const Projector rest(problem, problem.data, std::span(&noise, 1), 1);
  const Eigen::MatrixXd x = vector_of({0.0, 1.0, 2.0, 3.0});
  EXPECT_NEAR(rest.imitation(x)(0, 0), 1.5, 1e-12);
  const PartialRegression partial =
      partial_regression(problem, problem.data, std::span(&noise, 1), rest, {}, x);
  EXPECT_NEAR(partial.slope, 1.4, 1e-12);
  EXPECT_NEAR(partial.u, 0.5 / std::sqrt(5.0), 1e-12);
  EXPECT_LT((partial.driver - vector_of({-3.0, -1.0, 1.0, 3.0})).norm(), 1e-12);
  EXPECT_LT((partial.residual - vector_of({-4.0, 0.0, -2.0, 6.0})).norm(), 1e-12);
}

/// Of two amplitudes 3 and 4 the plot shows their combination, of size 5; observations that are left out are
/// not drawn.
TEST(FigureStatistics, SeveralAmplitudesAreShownAsTheirCombination) {
  NoiseProblem problem;
  problem.jacobian = Eigen::MatrixXd::Ones(6, 1);
  Eigen::MatrixXd columns(6, 2);
  columns << 1, 1, 1, -1, -1, 1, -1, -1, 1, 2, 5, 5;
  problem.residual = columns * Eigen::Vector2d(3.0, 4.0);
  problem.residual[5] = 1e6;
  problem.data = sequence_of({}, {1, 2, 3, 4, 5, 6});
  problem.data.sigma[5] = std::numeric_limits<double>::infinity();
  const NoiseParameters noise;
  const Projector rest(problem, problem.data, std::span(&noise, 1), 1);
  const PartialRegression partial =
      partial_regression(problem, problem.data, std::span(&noise, 1), rest, {}, columns);
  EXPECT_NEAR(partial.slope, 5.0, 1e-9);
  EXPECT_EQ(partial.driver[5], 0.0);
  EXPECT_EQ(partial.residual[5], 0.0);
  EXPECT_NEAR((partial.residual - 5.0 * partial.driver).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace volcal
