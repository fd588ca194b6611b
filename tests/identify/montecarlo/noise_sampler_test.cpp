// Drawn errors against the noise model's covariance entry by entry.

#include "volcal/identify/montecarlo/noise_sampler.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "tests/support/noise_campaigns.h"

namespace volcal {
namespace {

/// Two instruments; the first has times (out of order) and lines, and one reading left out.
NoiseData two_sequences() {
  NoiseData data;
  data.sigma = {1.0, 2.0, 1.0, std::numeric_limits<double>::infinity(), 1.5, 1.0, 2.0, 1.0};
  data.length = {0.5, 1.0, 1.5, 1.0, 2.0, 0.5, 1.0, 1.0};
  data.sequences.push_back({{0, 1, 2, 3, 4}, {0.0, 300.0, 100.0, 150.0, 200.0}, {1, 1, 2, 2, 2}, 0});
  data.sequences.push_back({{5, 6, 7}, {}, {}, 1});
  return data;
}

const std::vector<NoiseParameters> kSampledNoise = {{0.8, 1.1, 250.0, 0.7, 0.9}, {1.2, 0.5, 100.0, 0.4, 0.0}};

// Entries of 40,000 draws' mean outer product against Sigma within 5 standard errors sqrt((s_ii s_jj +
// s_ij^2) / n).
TEST(NoiseSampler, ErrorsHaveTheCovarianceOfTheNoiseModel) {
  constexpr int kDraws = 40000;
  const NoiseData data = two_sequences();
  const NoiseSampler sampler(data, kSampledNoise);
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(8, 8);
  Eigen::VectorXd errors(8);
  for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
    sampler.draw(2, draw, {errors.data(), 8});
    mean += errors * errors.transpose() / kDraws;
  }
  NoiseData kept = data;
  kept.sigma[3] = 1.0;
  const Eigen::MatrixXd sigma = test::dense_covariance(kept, kSampledNoise);
  for (Eigen::Index i = 0; i < 8; ++i) {
    for (Eigen::Index j = 0; j < 8; ++j) {
      const double expected = i == 3 || j == 3 ? 0.0 : sigma(i, j);
      const double error = std::sqrt((sigma(i, i) * sigma(j, j) + sigma(i, j) * sigma(i, j)) / kDraws);
      EXPECT_NEAR(mean(i, j), expected, 5.0 * error) << i << ", " << j;
    }
  }
}

// Without the reading that is left out.
TEST(Whitener, WeighIsTheInverseOfTheCovariance) {
  const NoiseData data = two_sequences();
  const Whitener whitener(data, kSampledNoise);
  NoiseData kept = data;
  kept.sigma[3] = 1.0;
  const Eigen::MatrixXd sigma = test::dense_covariance(kept, kSampledNoise);
  const std::vector<Eigen::Index> there = {0, 1, 2, 4, 5, 6, 7};
  const Eigen::VectorXd column = Eigen::VectorXd::LinSpaced(8, -1.0, 2.0);
  const Eigen::VectorXd expected =
      Eigen::MatrixXd(sigma(there, there)).llt().solve(Eigen::VectorXd(column(there)));
  const Eigen::VectorXd weighted = whitener.weigh(column);
  EXPECT_LT((weighted(there) - expected).norm(), 1e-12 * expected.norm());
  EXPECT_EQ(weighted[3], 0.0);
}

}  // namespace
}  // namespace volcal
