#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/long_tests.h"
#include "tests/support/noise_campaigns.h"
#include "tests/support/random_matrix.h"
#include "volcal/identify/noise/noise_estimate.h"

namespace volcal {
namespace {

constexpr double kTwoSided99 = 2.576;

struct FoundMoments {
  std::vector<double> values;

  double mean() const {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }
  double of_mean() const {  ///< standard uncertainty
    double sum = 0.0;
    for (const double value : values) sum += std::pow(value - mean(), 2);
    const auto n = static_cast<double>(values.size());
    return std::sqrt(sum / (n * (n - 1.0)));
  }
};

NoiseProblem campaign_of_grids(std::mt19937_64& generator) {
  NoiseProblem problem;
  test::GridPlan plan;
  plan.stations = 6;
  test::add_grid(plan, generator, problem);
  return problem;
}

/// Campaigns of 1,800 readings, 24 in every run and 60 for the night: the mean of every parameter inside the
/// 99 % interval of the mean (tau and correlated drift in logarithms: their distributions are skewed), stated
/// intervals cover.
TEST(NoiseStudy, RecoversWhatWasPutIn) {
  std::mt19937_64 generator(1);
  NoiseProblem problem = campaign_of_grids(generator);
  const NoiseParameters truth{1.3, 0.4e-6, 90.0, 0.3e-6, 0.0};
  const int campaigns = testing::short_or_long(24, 60);
  FoundMoments white, drift, tau, line;
  int drift_on = 0, line_on = 0, per_metre_on = 0, covered = 0, intervals = 0;
  const auto cover = [&](double found, double expected, double u) {
    covered += std::abs(std::log(found / expected)) < 1.96 * u ? 1 : 0;
    ++intervals;
  };
  for (int k = 0; k < campaigns; ++k) {
    problem.residual = test::draw_noise(problem.data, {truth}, generator);
    const InstrumentNoise own = estimate_noise(problem).instruments[0];
    white.values.push_back(own.parameters.white);
    cover(own.parameters.white, truth.white, own.log_uncertainty.white);
    drift_on += own.drift.on ? 1 : 0;
    line_on += own.line.on ? 1 : 0;
    per_metre_on += own.per_metre.on ? 1 : 0;
    if (own.drift.on) {
      drift.values.push_back(std::log(own.parameters.drift));
      tau.values.push_back(std::log(own.parameters.tau));
      cover(own.parameters.drift, truth.drift, own.log_uncertainty.drift);
      cover(own.parameters.tau, truth.tau, own.log_uncertainty.tau);
    }
    if (own.line.on) {
      line.values.push_back(own.parameters.line);
      cover(own.parameters.line, truth.line, own.log_uncertainty.line);
    }
  }
  const auto within = [](const FoundMoments& found, double expected) {
    return std::abs(found.mean() - expected) < kTwoSided99 * found.of_mean();
  };
  RecordProperty("drift_on", drift_on);
  RecordProperty("line_on", line_on);
  RecordProperty("covered", covered);
  RecordProperty("intervals", intervals);
  EXPECT_GE(drift_on, campaigns * 55 / 60);
  EXPECT_GE(line_on, campaigns * 57 / 60);
  EXPECT_LE(per_metre_on, campaigns / 10);
  EXPECT_TRUE(within(white, truth.white)) << white.mean() << " +- " << white.of_mean();
  EXPECT_TRUE(within(line, truth.line)) << line.mean() << " +- " << line.of_mean();
  EXPECT_TRUE(within(drift, std::log(truth.drift))) << std::exp(drift.mean()) << " +- " << drift.of_mean();
  EXPECT_TRUE(within(tau, std::log(truth.tau))) << std::exp(tau.mean()) << " +- " << tau.of_mean();
  EXPECT_GE(covered, static_cast<int>(0.90 * intervals)) << covered << " of " << intervals;
}

/// White noise stays white in at least 95 % of the campaigns, 60 in every run and 200 for the night.
TEST(NoiseStudy, WhiteStaysWhite) {
  std::mt19937_64 generator(2);
  NoiseProblem problem = campaign_of_grids(generator);
  const int campaigns = testing::short_or_long(60, 200);
  int white = 0, without_drift = 0, without_line = 0, without_per_metre = 0;
  for (int k = 0; k < campaigns; ++k) {
    problem.residual = test::draw_noise(problem.data, {{1.3, 0.0, 600.0, 0.0, 0.0}}, generator);
    const InstrumentNoise own = estimate_noise(problem).instruments[0];
    without_drift += own.drift.on ? 0 : 1;
    without_line += own.line.on ? 0 : 1;
    without_per_metre += own.per_metre.on ? 0 : 1;
    white += !own.drift.on && !own.line.on && !own.per_metre.on ? 1 : 0;
  }
  RecordProperty("without_drift", without_drift);
  RecordProperty("without_line", without_line);
  RecordProperty("without_per_metre", without_per_metre);
  RecordProperty("white", white);
  EXPECT_GE(white, campaigns * 95 / 100) << without_drift << ' ' << without_line << ' ' << without_per_metre;
}

/// Two-sided p of one more column, from the whitened model: the score after projection.
double score_probability(const Whitener& whitener, const NoiseProblem& problem, const Eigen::VectorXd& column,
                         bool rescale) {
  const Eigen::Index n = problem.jacobian.rows(), p = problem.jacobian.cols();
  Eigen::MatrixXd all(n, p + 2);
  all << problem.jacobian, column, problem.residual;
  whitener.whiten(all, all, 1);
  const Eigen::HouseholderQR<Eigen::MatrixXd> factor(all);
  const double along = factor.matrixQR()(p, p + 1);
  const double rest = factor.matrixQR()(p + 1, p + 1);
  const double scale = rescale ? std::sqrt((along * along + rest * rest) / static_cast<double>(n - p)) : 1.0;
  return std::erfc(std::abs(along) / (scale * std::numbers::sqrt2));
}

/// A wave of time, or of position along the beam, of random period and phase.
Eigen::VectorXd smooth_column(const NoiseProblem& problem, bool of_time, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform;
  const double period = 200.0 + 1000.0 * uniform(generator),
               phase = 2.0 * std::numbers::pi * uniform(generator);
  const Eigen::VectorXd mixture = test::random_matrix(generator, problem.jacobian.cols(), 1);
  Eigen::VectorXd column(problem.jacobian.rows());
  for (const NoiseSequence& sequence : problem.data.sequences) {
    for (std::size_t k = 0; k < sequence.observation.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(sequence.observation[k]);
      const double argument =
          of_time ? 2.0 * std::numbers::pi * sequence.time[k] / period : problem.jacobian.row(i).dot(mixture);
      column(i) = std::sin(argument + phase);
    }
  }
  return column;
}

/// Two tests of a random smooth column on every campaign without any such effect, 60 campaigns in every run
/// and 200 for the night. Estimated noise: 5 % false alarms (within the 99 % binomial interval, 2.2 to 7.8 %
/// of 400 tests) and p as good as uniform (Kolmogorov, 1 %); ordinary weighting with an estimated sigma0 has
/// three times as many.
TEST(NoiseStudy, ScoresAreCalibratedWithEstimatedNoise) {
  std::mt19937_64 generator(3);
  NoiseProblem problem = campaign_of_grids(generator);
  const NoiseParameters truth{1.0, 0.4e-6, 200.0, 0.25e-6, 0.0};
  const Whitener ordinary(problem.data, std::vector<NoiseParameters>(1));
  std::vector<double> probability;
  int alarms = 0, ordinary_alarms = 0;
  const int campaigns = testing::short_or_long(60, 200);
  for (int k = 0; k < campaigns; ++k) {
    problem.residual = test::draw_noise(problem.data, {truth}, generator);
    const Whitener whitener(problem.data, estimate_noise(problem).parameters());
    for (const bool of_time : {true, false}) {
      const Eigen::VectorXd column = smooth_column(problem, of_time, generator);
      probability.push_back(score_probability(whitener, problem, column, false));
      alarms += probability.back() < 0.05 ? 1 : 0;
      ordinary_alarms += score_probability(ordinary, problem, column, true) < 0.05 ? 1 : 0;
    }
  }
  std::ranges::sort(probability);
  const auto n = static_cast<double>(probability.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < probability.size(); ++i)
    distance = std::max(distance, std::abs(probability[i] - (static_cast<double>(i) + 0.5) / n));
  RecordProperty("alarms", alarms);
  RecordProperty("ordinary_alarms", ordinary_alarms);
  const double chance = 2.576 * std::sqrt(0.05 * 0.95 * n);
  EXPECT_NEAR(alarms, 0.05 * n, chance) << ordinary_alarms;
  EXPECT_LT(distance, 1.63 / std::sqrt(n));
  EXPECT_GT(ordinary_alarms, 0.15 * n);
}

}  // namespace
}  // namespace volcal
