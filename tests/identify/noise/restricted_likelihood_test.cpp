#include "volcal/identify/noise/restricted_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "tests/support/noise_campaigns.h"
#include "tests/support/random_matrix.h"

namespace volcal {
namespace {

const std::vector<NoiseParameters> kNoises{{1.2, 0.5e-6, 40.0, 0.3e-6, 0.2e-6},
                                           {0.8, 0.2e-6, 300.0, 0.0, 0.0}};

/// Two instruments that share the coefficients of the grid.
NoiseProblem two_instruments(std::mt19937_64& generator) {
  NoiseProblem problem;
  test::GridPlan plan;
  plan.stations = 2;
  plan.points = {6, 4, 3};
  plan.terms = 1;
  test::add_grid(plan, generator, problem);
  plan.group = 1;
  test::add_grid(plan, generator, problem);
  problem.residual = test::draw_noise(problem.data, kNoises, generator);
  problem.residual += problem.jacobian * Eigen::VectorXd::Constant(problem.jacobian.cols(), 3e-6);
  return problem;
}

void add_prior(NoiseProblem& problem, std::mt19937_64& generator) {
  const Eigen::Index p = problem.jacobian.cols();
  const Eigen::MatrixXd root = test::random_matrix(generator, p, p) + 2.0 * Eigen::MatrixXd::Identity(p, p);
  problem.prior_precision = 1e11 * root.transpose() * root;
  problem.prior_mean = Eigen::VectorXd::Constant(p, 2e-6);
}

TEST(RestrictedLikelihood, EqualsDenseFormula) {
  std::mt19937_64 generator(1);
  NoiseProblem problem = two_instruments(generator);
  EXPECT_NEAR(RestrictedLikelihood(problem, 1).log_likelihood(kNoises),
              test::dense_log_likelihood(problem, kNoises), 1e-6);
  add_prior(problem, generator);
  EXPECT_NEAR(RestrictedLikelihood(problem, 1).log_likelihood(kNoises),
              test::dense_log_likelihood(problem, kNoises), 1e-6);
}

/// The coefficients are those of generalised least squares with the prior.
TEST(RestrictedLikelihood, SolutionIsGeneralisedLeastSquares) {
  std::mt19937_64 generator(2);
  NoiseProblem problem = two_instruments(generator);
  add_prior(problem, generator);
  RestrictedLikelihood likelihood(problem, 1);
  Eigen::MatrixXd gram = likelihood.prior().gram;
  for (std::size_t g = 0; g < 2; ++g) gram += likelihood.share(g, kNoises[g]).gram;
  const Eigen::VectorXd x = likelihood.coefficients(RestrictedLikelihood::solve(gram).at);

  const Eigen::LLT<Eigen::MatrixXd> factor(test::dense_covariance(problem.data, kNoises));
  const Eigen::MatrixXd weighted = factor.solve(problem.jacobian);
  const Eigen::VectorXd expected =
      (problem.jacobian.transpose() * weighted + problem.prior_precision)
          .llt()
          .solve(weighted.transpose() * problem.residual + problem.prior_precision * problem.prior_mean);
  EXPECT_LT((x - expected).norm() / expected.norm(), 1e-8);
}

/// A prior that leaves little to the readings in half of the directions: these are held where white noise
/// puts them, and the likelihood follows the dense one within what they can say.
TEST(RestrictedLikelihood, HoldsWhatThePriorDecides) {
  std::mt19937_64 generator(6);
  NoiseProblem problem = two_instruments(generator);
  const Eigen::Index p = problem.jacobian.cols(), held = p / 2;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(p, p);
  Eigen::VectorXd weighted = Eigen::VectorXd::Zero(p);
  for (Eigen::Index i = 0; i < problem.jacobian.rows(); ++i) {
    const double sigma = problem.data.sigma[static_cast<std::size_t>(i)];
    information += problem.jacobian.row(i).transpose() * problem.jacobian.row(i) / (sigma * sigma);
    weighted += problem.jacobian.row(i).transpose() * problem.residual[i] / (sigma * sigma);
  }
  const Eigen::MatrixXd lower = information.llt().matrixL();
  Eigen::VectorXd strength = Eigen::VectorXd::Ones(p);  // of the prior against the readings
  for (Eigen::Index k = 0; k < held; ++k) strength[k] = std::pow(10.0, 3.1 + 0.2 * static_cast<double>(k));
  problem.prior_precision = lower * strength.asDiagonal() * lower.transpose();
  problem.prior_mean = Eigen::VectorXd::Constant(p, 3e-6);

  RestrictedLikelihood likelihood(problem, 1);
  EXPECT_EQ(likelihood.variables(), p - held);
  const std::vector<NoiseParameters> white(2);
  EXPECT_NEAR(likelihood.log_likelihood(white), test::dense_log_likelihood(problem, white), 1e-6);
  const double held_back = likelihood.log_likelihood(kNoises);
  const double dense = test::dense_log_likelihood(problem, kNoises);
  EXPECT_NEAR(held_back, dense, 4.0 * kMinInformation * static_cast<double>(held));
  EXPECT_NE(held_back, dense);
  const Eigen::VectorXd at = Eigen::VectorXd::Zero(p - held);
  const Eigen::VectorXd estimate = (information + problem.prior_precision)
                                       .llt()
                                       .solve(weighted + problem.prior_precision * problem.prior_mean);
  EXPECT_LT((likelihood.coefficients(at) - estimate).norm(), 1e-9 * estimate.norm());
}

/// Shares that are known from other residuals count with those that are there now: held to the dense formula.
TEST(RestrictedLikelihood, OtherResidualsOfTheSameColumns) {
  std::mt19937_64 generator(7);
  NoiseProblem problem = two_instruments(generator);
  add_prior(problem, generator);
  problem.data.sigma[5] = std::numeric_limits<double>::infinity();
  RestrictedLikelihood likelihood(problem, 1);
  const double first = likelihood.log_likelihood(kNoises);
  const Eigen::VectorXd residual = problem.residual;
  problem.residual = 2.0 * test::draw_noise(problem.data, kNoises, generator);
  problem.residual(5) = 1.0;  // a blunder without weight
  likelihood.set_residual(problem);
  const double known = likelihood.log_likelihood(kNoises);
  EXPECT_GT(std::abs(known - first), 10.0);
  EXPECT_NEAR(known, RestrictedLikelihood(problem, 1).log_likelihood(kNoises), 1e-7);
  const std::vector<NoiseParameters> unasked{{1.0, 0.1e-6, 100.0, 0.5e-6, 0.0},
                                             {1.5, 0.0, 1.0, 0.2e-6, 0.1e-6}};
  EXPECT_NEAR(likelihood.log_likelihood(unasked), RestrictedLikelihood(problem, 1).log_likelihood(unasked),
              1e-7);

  NoiseProblem dense = problem;  // a sigma that leaves nothing of the reading
  dense.data.sigma[5] = 1e3;
  const double left = 2.0 * (known - likelihood.log_likelihood(unasked));
  const double expected =
      2.0 * (test::dense_log_likelihood(dense, kNoises) - test::dense_log_likelihood(dense, unasked));
  const double of_blunder = 2.0 * std::log(unasked[0].white / kNoises[0].white);
  EXPECT_NEAR(left, expected - of_blunder, 1e-4);

  problem.residual = residual;
  likelihood.set_residual(problem);
  EXPECT_NEAR(likelihood.log_likelihood(kNoises), first, 1e-7);
  problem.residual.conservativeResize(3);
  EXPECT_THROW(likelihood.set_residual(problem), std::invalid_argument);
}

/// A reading without weight is as good as one that was never taken.
TEST(RestrictedLikelihood, MissingReadingsAreAbsent) {
  std::mt19937_64 generator(3);
  NoiseProblem problem;
  test::GridPlan plan;
  plan.points = {6, 3, 3};
  plan.terms = 1;
  test::add_grid(plan, generator, problem);
  problem.residual = test::draw_noise(problem.data, kNoises, generator);
  NoiseProblem shorter = problem;
  for (const std::size_t i : {3U, 17U, 60U}) problem.data.sigma[i] = std::numeric_limits<double>::infinity();
  problem.residual(17) = 1.0;  // a blunder
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < problem.residual.size(); ++i) {
    if (std::isfinite(problem.data.sigma[static_cast<std::size_t>(i)])) kept.push_back(i);
  }
  std::size_t next = 0;
  std::vector<double> sigma, length;
  for (NoiseSequence& sequence : shorter.data.sequences) {
    const NoiseSequence all = sequence;
    sequence = {{}, {}, {}, all.group};
    for (std::size_t k = 0; k < all.observation.size(); ++k) {
      const std::size_t i = all.observation[k];
      if (!std::isfinite(problem.data.sigma[i])) continue;
      sequence.observation.push_back(next++);
      sequence.time.push_back(all.time[k]);
      sequence.line.push_back(all.line[k]);
      sigma.push_back(problem.data.sigma[i]);
      length.push_back(problem.data.length[i]);
    }
  }
  shorter.data.sigma = sigma;
  shorter.data.length = length;
  shorter.jacobian = problem.jacobian(kept, Eigen::all).eval();
  shorter.residual = problem.residual(kept).eval();
  const double expected = test::dense_log_likelihood(shorter, kNoises);
  EXPECT_NEAR(RestrictedLikelihood(problem, 1).log_likelihood(kNoises), expected, 1e-6);
}

/// A column twice says nothing new: differences of the likelihood stay the same.
TEST(RestrictedLikelihood, DependentColumnsAreLeftOut) {
  std::mt19937_64 generator(4);
  NoiseProblem problem = two_instruments(generator);
  RestrictedLikelihood likelihood(problem, 1);
  const Eigen::Index p = problem.jacobian.cols();
  NoiseProblem twice = problem;
  twice.jacobian.edit([&](Eigen::MatrixXd& jacobian) {
    jacobian.conservativeResize(Eigen::NoChange, p + 2);
    jacobian.col(p) = problem.jacobian.col(0) - 2.0 * problem.jacobian.col(3);
    jacobian.col(p + 1).setZero();
  });
  RestrictedLikelihood same(twice, 1);
  EXPECT_EQ(same.variables(), p);
  const std::vector<NoiseParameters> other{{1.0, 0.1e-6, 100.0, 0.5e-6, 0.0},
                                           {1.5, 0.0, 1.0, 0.2e-6, 0.1e-6}};
  EXPECT_NEAR(same.log_likelihood(kNoises) - same.log_likelihood(other),
              likelihood.log_likelihood(kNoises) - likelihood.log_likelihood(other), 1e-6);
}

TEST(RestrictedLikelihood, RefusesSizesThatDisagree) {
  std::mt19937_64 generator(5);
  NoiseProblem problem = two_instruments(generator);
  problem.prior_mean = Eigen::VectorXd::Zero(2);
  EXPECT_THROW(RestrictedLikelihood(problem, 1), std::invalid_argument);
  problem = two_instruments(generator);
  problem.residual.conservativeResize(3);
  EXPECT_THROW(RestrictedLikelihood(problem, 1), std::invalid_argument);
}

}  // namespace
}  // namespace volcal
