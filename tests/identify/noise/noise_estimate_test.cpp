#include "volcal/identify/noise/noise_estimate.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "tests/support/noise_campaigns.h"
#include "tests/support/random_matrix.h"
#include "volcal/identify/numeric/bounded_minimum.h"

namespace volcal {
namespace {

NoiseProblem grid(std::mt19937_64& generator, const NoiseParameters& noise, const Eigen::Vector3i& points,
                  int stations) {
  NoiseProblem problem;
  test::GridPlan plan;
  plan.stations = stations;
  plan.points = points;
  plan.terms = 1;
  test::add_grid(plan, generator, problem);
  problem.residual = test::draw_noise(problem.data, {noise}, generator);
  return problem;
}

/// Rosenbrock's valley, and its lowest point in a box that leaves the minimum out: x = 0.5, y = x^2.
TEST(BoundedMinimum, ValleyAndBound) {
  const auto valley = [](const Eigen::VectorXd& x) {
    return 100.0 * std::pow(x(1) - x(0) * x(0), 2) + std::pow(1.0 - x(0), 2);
  };
  Box box{Eigen::Vector2d(-2.0, -2.0), Eigen::Vector2d(2.0, 2.0)};
  const Minimum free = bounded_minimum(valley, Eigen::Vector2d(-1.2, 1.0), box, 1e-10, 200);
  EXPECT_LT((free.at - Eigen::Vector2d(1.0, 1.0)).norm(), 2e-3);
  box.upper(0) = 0.5;
  const Minimum bound = bounded_minimum(valley, Eigen::Vector2d(-1.2, 1.0), box, 1e-10, 200);
  EXPECT_LT((bound.at - Eigen::Vector2d(0.5, 0.25)).norm(), 2e-3);
}

/// No point that a direct search of the dense formula finds is better.
TEST(NoiseEstimate, IsTheMaximumOfTheDenseLikelihood) {
  std::mt19937_64 generator(1);
  for (int k = 0; k < 3; ++k) {
    const NoiseProblem problem = grid(generator, {1.0, 0.5e-6, 60.0, 0.4e-6, 0.0}, {6, 4, 3}, 2);
    NoiseOptions options;
    options.threshold = options.drift_threshold = 0.0;
    options.per_metre = false;
    const NoiseEstimate estimate = estimate_noise(problem, options);
    const NoiseParameters& found = estimate.instruments[0].parameters;
    EXPECT_NEAR(estimate.log_likelihood, test::dense_log_likelihood(problem, estimate.parameters()), 1e-6);

    const auto dense = [&](const Eigen::VectorXd& at) {
      const NoiseParameters noise{std::exp(at(0)), std::exp(at(1)), std::exp(at(2)), std::exp(at(3)), 0.0};
      return -2.0 * test::dense_log_likelihood(problem, {noise});
    };
    Eigen::VectorXd at(4);
    at << std::log(found.white), std::log(std::max(found.drift, 1e-8)), std::log(found.tau),
        std::log(std::max(found.line, 1e-8));
    Box box{at.array() - 2.0, at.array() + 2.0};
    box.lower(2) =
        std::log(6.0);  // limits of the search: twice the usual gap, three times the longest sequence
    box.upper(2) = std::log(3.0 * 350.0);
    for (const double away : {0.0, 0.7, -0.7}) {
      const Minimum best = bounded_minimum(dense, at.array() + away, box, 1e-4, 60);
      EXPECT_LT(-2.0 * estimate.log_likelihood - best.value, 0.05) << k << ' ' << away;
    }
  }
}

/// Shares of the likelihood ratio: adding a term and dropping it again.
TEST(NoiseEstimate, LikelihoodRatioIsThatOfTheSmallerModel) {
  std::mt19937_64 generator(2);
  const NoiseProblem problem = grid(generator, {1.0, 0.3e-6, 60.0, 0.3e-6, 0.0}, {8, 5, 4}, 3);
  const NoiseEstimate all = estimate_noise(problem);
  ASSERT_TRUE(all.instruments[0].line.on);
  NoiseOptions options;
  options.line = false;
  const NoiseEstimate without = estimate_noise(problem, options);
  EXPECT_FALSE(without.instruments[0].line.possible);
  EXPECT_NEAR(all.instruments[0].line.likelihood_ratio, 2.0 * (all.log_likelihood - without.log_likelihood),
              0.5);
}

TEST(NoiseEstimate, WhatTheDataCannotSayIsOff) {
  std::mt19937_64 generator(3);
  NoiseProblem problem = grid(generator, {1.0, 0.6e-6, 60.0, 0.5e-6, 0.0}, {8, 5, 4}, 3);
  for (NoiseSequence& sequence : problem.data.sequences) {
    sequence.time.clear();
    sequence.line.clear();
  }
  problem.data.length.clear();
  const NoiseEstimate estimate = estimate_noise(problem);
  const InstrumentNoise& own = estimate.instruments[0];
  EXPECT_FALSE(own.drift.possible || own.line.possible || own.per_metre.possible);
  EXPECT_EQ(own.parameters.drift, 0.0);
  EXPECT_EQ(own.parameters.line, 0.0);
  const auto rows = noise_table(estimate);
  ASSERT_EQ(rows.size(), 5U);
  EXPECT_EQ(rows[0].term, "white");
  EXPECT_LT(rows[0].low, rows[0].value);
  EXPECT_GT(rows[0].high, rows[0].value);
  EXPECT_EQ(rows[1].remark, "off: no times, or too few readings");
  EXPECT_EQ(rows[3].remark, "off: no lines of several readings");
}

/// Nine readings, eleven coefficients: the stated sigma stays.
TEST(NoiseEstimate, TooFewReadingsKeepTheStatedSigma) {
  std::mt19937_64 generator(4);
  const NoiseProblem problem = grid(generator, {1.0, 0.0, 60.0, 0.0, 0.0}, {3, 3, 1}, 1);
  const NoiseEstimate estimate = estimate_noise(problem);
  EXPECT_FALSE(estimate.instruments[0].estimated);
  EXPECT_EQ(estimate.instruments[0].parameters.white, 1.0);
  EXPECT_EQ(noise_table(estimate)[0].remark, "stated: too few redundant readings");
}

/// Each instrument gets its own noise, though they share the coefficients.
TEST(NoiseEstimate, TwoInstruments) {
  std::mt19937_64 generator(5);
  NoiseProblem problem;
  test::GridPlan plan;
  plan.stations = 4;
  test::add_grid(plan, generator, problem);
  plan.group = 1;
  plan.sigma = 1e-6;
  test::add_grid(plan, generator, problem);
  const std::vector<NoiseParameters> truth{{0.7, 0.0, 600.0, 0.0, 0.0}, {1.5, 0.0, 600.0, 1.2e-6, 0.0}};
  problem.residual = test::draw_noise(problem.data, truth, generator);
  const NoiseEstimate estimate = estimate_noise(problem);
  EXPECT_NEAR(estimate.instruments[0].parameters.white, 0.7, 0.06);
  EXPECT_FALSE(estimate.instruments[0].line.on);
  EXPECT_NEAR(estimate.instruments[1].parameters.white, 1.5, 0.12);
  EXPECT_NEAR(estimate.instruments[1].parameters.line, 1.2e-6, 0.3e-6);
  EXPECT_FALSE(estimate.instruments[1].drift.on);
  EXPECT_NEAR(estimate.log_likelihood, RestrictedLikelihood(problem, 1).log_likelihood(estimate.parameters()),
              1e-6);
}

/// Noise in proportion to length, of lengths between half a metre and two, beside stated noise of its size.
TEST(NoiseEstimate, FindsNoiseInProportionToLength) {
  std::mt19937_64 generator(9);
  const NoiseProblem problem = grid(generator, {1.0, 0.0, 60.0, 0.0, 0.5e-6}, {12, 5, 5}, 3);
  const InstrumentNoise own = estimate_noise(problem).instruments[0];
  ASSERT_TRUE(own.per_metre.on);
  EXPECT_NEAR(own.parameters.per_metre, 0.5e-6, 0.1e-6);
  EXPECT_LT(std::abs(std::log(own.parameters.per_metre / 0.5e-6)), 3.0 * own.log_uncertainty.per_metre);
  EXPECT_NEAR(own.parameters.white, 1.0, 0.25);
  EXPECT_FALSE(own.drift.on || own.line.on);
}

void expect_same_noise(const NoiseEstimate& a, const NoiseEstimate& b) {
  EXPECT_NEAR(a.log_likelihood, b.log_likelihood, 0.02);
  for (std::size_t g = 0; g < a.instruments.size(); ++g) {
    EXPECT_EQ(a.instruments[g].drift.on, b.instruments[g].drift.on);
    EXPECT_EQ(a.instruments[g].line.on, b.instruments[g].line.on);
    EXPECT_EQ(a.instruments[g].per_metre.on, b.instruments[g].per_metre.on);
    EXPECT_NEAR(std::log(a.instruments[g].parameters.white / b.instruments[g].parameters.white), 0.0, 0.01);
  }
}

/// One more column, and the search from the end of the one without it finds what a search from nothing finds.
TEST(NoiseEstimate, BeginsAtThePreviousEnd) {
  std::mt19937_64 generator(7);
  NoiseProblem problem = grid(generator, {1.0, 0.5e-6, 60.0, 0.4e-6, 0.0}, {8, 5, 4}, 3);
  const NoiseEstimate before = estimate_noise(problem);
  const Eigen::Index p = problem.jacobian.cols();
  problem.jacobian.edit([&](Eigen::MatrixXd& jacobian) {
    jacobian.conservativeResize(Eigen::NoChange, p + 1);
    jacobian.col(p) = test::random_matrix(generator, jacobian.rows(), 1);
  });
  if (problem.prior_precision.size() > 0) {
    problem.prior_precision.conservativeResizeLike(Eigen::MatrixXd::Zero(p + 1, p + 1));
  }
  const NoiseEstimate cold = estimate_noise(problem);
  const NoiseEstimate warm = estimate_noise(problem, {}, &before);
  expect_same_noise(cold, warm);
  EXPECT_LT(warm.evaluations, 0.7 * cold.evaluations);
}

/// A step in half of the readings, line by line, is taken for offsets of lines; with it in the model they go.
/// Held to the estimate that finds all anew.
TEST(NoiseEstimate, ReadjustedToWhatAColumnExplains) {
  std::mt19937_64 generator(11);
  NoiseProblem problem = grid(generator, {1.0, 0.0, 60.0, 0.0, 0.0}, {8, 5, 4}, 3);
  const Eigen::Index count = problem.jacobian.rows(), p = problem.jacobian.cols();
  Eigen::MatrixXd column(count, 1);
  for (const NoiseSequence& sequence : problem.data.sequences) {
    for (std::size_t k = 0; k < sequence.observation.size(); ++k)
      column(static_cast<Eigen::Index>(sequence.observation[k]), 0) =
          sequence.line[k] % 2 == 0 ? 0.5e-6 : -0.5e-6;
  }
  problem.residual += 3.0 * column.col(0);
  const NoiseEstimate before = estimate_noise(problem);
  ASSERT_GT(before.instruments[0].parameters.line, 1e-6);

  NoiseProblem all = problem;
  all.jacobian.edit([&](Eigen::MatrixXd& jacobian) {
    jacobian.conservativeResize(Eigen::NoChange, p + 1);
    jacobian.col(p) = column.col(0);
  });
  if (all.prior_precision.size() > 0)
    all.prior_precision.conservativeResizeLike(Eigen::MatrixXd::Zero(p + 1, p + 1));
  const NoiseEstimate anew = estimate_noise(all);

  // Off the model and about the solution at the noise before: by dense algebra.
  const Eigen::MatrixXd sigma = test::dense_covariance(problem.data, before.parameters());
  const Eigen::LLT<Eigen::MatrixXd> factor(sigma);
  const auto solved = [&](const Eigen::MatrixXd& of, const Eigen::MatrixXd& right) -> Eigen::MatrixXd {
    const Eigen::MatrixXd weighed = factor.solve(of);
    return (of.transpose() * weighed).ldlt().solve(weighed.transpose() * right);
  };
  NoiseProblem few;
  few.jacobian = column - problem.jacobian * solved(problem.jacobian, column);
  few.residual = all.residual - all.jacobian * solved(all.jacobian, all.residual);
  few.data = problem.data;
  const NoiseEstimate found = readjust_noise(few, {}, before);
  EXPECT_EQ(anew.instruments[0].parameters.line, 0.0);
  EXPECT_LT(found.instruments[0].parameters.line, 0.2e-6)  // the rest of the solution is held
      << "was " << before.instruments[0].parameters.line;
  EXPECT_NEAR(found.instruments[0].parameters.white, anew.instruments[0].parameters.white, 0.03);

  // Nothing added: nothing to give back.
  few.residual = problem.residual - problem.jacobian * solved(problem.jacobian, problem.residual);
  const Eigen::MatrixXd other = test::random_matrix(generator, count, 1);
  few.jacobian = other - problem.jacobian * solved(problem.jacobian, other);
  const NoiseEstimate same = readjust_noise(few, {}, before);
  EXPECT_NEAR(std::log(same.instruments[0].parameters.line / before.instruments[0].parameters.line), 0.0,
              0.05);
  EXPECT_NEAR(std::log(same.instruments[0].parameters.white / before.instruments[0].parameters.white), 0.0,
              0.01);
}

/// A start that lacks a term, or has one that is not there, is given up.
TEST(NoiseEstimate, ATermThatComesOrGoesIsFound) {
  std::mt19937_64 generator(8);
  const NoiseProblem white = grid(generator, {1.0, 0.0, 60.0, 0.0, 0.0}, {8, 5, 4}, 3);
  const NoiseProblem lines = grid(generator, {1.0, 0.0, 60.0, 1e-6, 0.0}, {8, 5, 4}, 3);
  const NoiseEstimate of_white = estimate_noise(white), of_lines = estimate_noise(lines);
  ASSERT_TRUE(of_lines.instruments[0].line.on && !of_white.instruments[0].line.on);
  expect_same_noise(estimate_noise(lines, {}, &of_white), of_lines);
  expect_same_noise(estimate_noise(white, {}, &of_lines), of_white);
}

/// A search that began where an effect had been taken for a fast correlated drift would end in a lower
/// maximum.
TEST(NoiseEstimate, AnEndForOtherResidualsIsNoStart) {
  std::mt19937_64 generator(3);
  const NoiseProblem problem = grid(generator, {1.0, 0.5e-6, 120.0, 0.3e-6, 0.0}, {8, 5, 4}, 3);
  const NoiseEstimate cold = estimate_noise(problem);
  NoiseProblem disturbed = problem;
  disturbed.residual +=
      test::draw_noise(problem.data, {NoiseParameters{0.01, 10e-6, 9.0, 0.0, 0.0}}, generator);
  const NoiseEstimate before = estimate_noise(disturbed);
  ASSERT_LT(before.instruments[0].parameters.tau, 30.0);
  expect_same_noise(cold, estimate_noise(problem, {}, &before));
}

/// A slow swing that correlated drift holds, taken away: next to the noise that held it lies what a search
/// from nothing finds, and the terms that have become needless add less than they need to stay.
TEST(NoiseEstimate, LikelihoodNextToAnEarlierEnd) {
  std::mt19937_64 generator(12);
  NoiseProblem problem = grid(generator, {1.0, 0.2e-6, 60.0, 0.4e-6, 0.0}, {8, 5, 4}, 3);
  Eigen::VectorXd swing(problem.residual.size());
  for (const NoiseSequence& sequence : problem.data.sequences) {
    for (std::size_t k = 0; k < sequence.observation.size(); ++k)
      swing(static_cast<Eigen::Index>(sequence.observation[k])) = 1e-6 * std::sin(sequence.time[k] / 80.0);
  }
  problem.residual += swing;
  const NoiseOptions options;
  RestrictedLikelihood likelihood(problem, 1);
  const NoiseEstimate before = estimate_noise(likelihood, options);
  ASSERT_GT(before.instruments[0].parameters.drift, 0.4e-6);
  for (const double share : {0.0, 0.5, 1.0}) {
    NoiseProblem without = problem;
    without.residual -= share * swing;
    likelihood.set_residual(without);
    const double nearby = nearby_log_likelihood(likelihood, options, before);
    const double anew = estimate_noise(without, options).log_likelihood;
    EXPECT_GT(nearby, anew - 0.5) << share;
    EXPECT_LT(nearby, anew + 0.5 * (options.drift_threshold + 2.0 * options.threshold)) << share;
    EXPECT_NEAR(estimate_noise(likelihood, options, &before).log_likelihood, anew, 0.05) << share;
  }
}

/// Returns to the same points only start the search elsewhere.
TEST(NoiseEstimate, RepeatedPointsLeadToTheSameMaximum) {
  std::mt19937_64 generator(6);
  NoiseProblem problem = grid(generator, {1.0, 0.5e-6, 60.0, 0.0, 0.0}, {8, 5, 4}, 3);
  const NoiseEstimate plain = estimate_noise(problem);
  for (std::size_t i = 0; i < problem.data.sigma.size(); ++i)
    problem.point.push_back(static_cast<std::int64_t>(i % 20));
  const NoiseEstimate repeated = estimate_noise(problem);
  EXPECT_NEAR(plain.log_likelihood, repeated.log_likelihood, 0.02);
}

}  // namespace
}  // namespace volcal
