// A model state against plain matrix algebra.

#include "volcal/identify/criticism/search/model_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "tests/support/search_states.h"

namespace volcal {
namespace {

using testing_support::FittedStudy;
using testing_support::hiding;
using testing_support::reversal;
using testing_support::setting_of;
using testing_support::test_of;

const Eigen::Vector3i kStateGrid{5, 4, 3};

/// A backlash of EYY at its amplitude; made once.
class ModelStateOfReversal : public ::testing::Test {
 protected:
  static const FittedStudy& study() {
    static const FittedStudy fitted(hiding({reversal("EYY", 1.5e-6)}, kStateGrid));
    return fitted;
  }
  static const ModelState& given() {
    static const ModelState state = ModelState(study().model, setting_of(study().model)).tested();
    return state;
  }
  static const FamilyTest& backlash() { return test_of(given(), {"reversal", "EYY", "dir_y", "step"}); }
  static const ModelState& reached() {
    static const ModelState state = given().with(backlash());
    return state;
  }
};

TEST_F(ModelStateOfReversal, AFurtherEffectGivesAnotherState) {
  EXPECT_TRUE(given().added().empty());
  EXPECT_FALSE(given().has(backlash().family));
  ASSERT_EQ(reached().added().size(), 1U);
  EXPECT_TRUE(reached().has(backlash().family));
  EXPECT_EQ(given().steps().size(), 1U);
  EXPECT_EQ(reached().steps().size(), 2U);
  EXPECT_FALSE(reached().is_tested());
  EXPECT_THROW(static_cast<void>(reached().tests()), std::logic_error);
  EXPECT_EQ(reached().first_column(0), given().projector().parameters());
}

/// As it was before the second effect came in, whatever that did to noise and smoothing.
TEST_F(ModelStateOfReversal, GoesBackToItsFirstEffects) {
  const FamilyTest& other = test_of(given(), {"reversal", "EXX", "dir_x", "step"});
  const ModelState two = reached().with(other);
  const std::optional<ModelState> again = two.with_first(1);
  ASSERT_TRUE(again.has_value());
  ASSERT_EQ(again->added().size(), 1U);
  EXPECT_EQ(again->steps().size(), 2U);
  EXPECT_EQ(again->added()[0].test.family, backlash().family);
  EXPECT_EQ(again->residual(), reached().residual());
  EXPECT_EQ(again->projector().residual_squares(), reached().projector().residual_squares());
}

/// Effects have no prior, and the model's columns stay as they are.
TEST_F(ModelStateOfReversal, TheProblemHasTheEffectsAsFurtherColumns) {
  const NoiseProblem& own = reached().model().problem();
  const NoiseProblem problem = reached().problem();
  const Eigen::Index p = own.jacobian.cols();
  ASSERT_EQ(problem.jacobian.cols(), p + 1);
  EXPECT_EQ(problem.jacobian.leftCols(p), own.jacobian);
  EXPECT_EQ(problem.jacobian.col(p), reached().added()[0].columns.col(0));
  EXPECT_EQ(problem.prior_precision.topLeftCorner(p, p), own.prior_precision);
  EXPECT_TRUE(problem.prior_precision.col(p).isZero());
  EXPECT_EQ(problem.prior_mean[p], 0.0);
}

/// Amplitude and what it leaves by dense generalised least squares with the covariance of the noise model.
TEST_F(ModelStateOfReversal, EstimatesAsDenseLeastSquaresDo) {
  const NoiseProblem problem = reached().problem();
  const Eigen::Index n = problem.jacobian.rows(), p = problem.jacobian.cols();
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (const NoiseSequence& sequence : problem.data.sequences) {
    const NoiseParameters& noise = reached().noise()[sequence.group];
    for (std::size_t i = 0; i < sequence.observation.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(sequence.observation[i]);
      const double white = noise.white * problem.data.sigma[sequence.observation[i]];
      const double by_length = noise.per_metre * problem.data.length[sequence.observation[i]];
      covariance(row, row) += white * white + by_length * by_length;
      for (std::size_t j = 0; j < sequence.observation.size(); ++j) {
        const auto column = static_cast<Eigen::Index>(sequence.observation[j]);
        const double gap = std::abs(sequence.time[i] - sequence.time[j]);
        covariance(row, column) += noise.drift * noise.drift * std::exp(-gap / noise.tau);
        if (!sequence.line.empty() && sequence.line[i] == sequence.line[j])
          covariance(row, column) += noise.line * noise.line;
      }
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  const Eigen::MatrixXd weighted = factor.solve(problem.jacobian);
  const Eigen::MatrixXd information = problem.jacobian.transpose() * weighted + problem.prior_precision;
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd right =
      weighted.transpose() * problem.residual + problem.prior_precision * problem.prior_mean;
  const Eigen::VectorXd solution =
      scale.asDiagonal() *
      (scale.asDiagonal() * information * scale.asDiagonal()).ldlt().solve(scale.asDiagonal() * right);
  const double amplitude = reached().projector().solution()[p - 1];
  EXPECT_NEAR(amplitude, solution[p - 1], 1e-6 * std::abs(solution[p - 1]));
  const double u = std::sqrt(reached().projector().accepted_covariance()(0, 0));
  EXPECT_NEAR(std::abs(amplitude), std::abs(study().simulated.hidden.at(0).amplitude), 4.0 * u);
}

/// At one noise, columns that enter the model take away their LM.
TEST_F(ModelStateOfReversal, WhatAnEffectTakesAwayIsItsLm) {
  const auto before = reached().projector_without({0});
  const Eigen::MatrixXd& columns = reached().added()[0].columns;
  const double lm = score_test(before->project(columns), 0, columns.cols()).lm;
  EXPECT_NEAR(before->residual_squares() - reached().projector().residual_squares(), lm, 1e-6 * lm);
}

/// Readings that a fit without the backlash took for outliers are none beside it, and stay out without it.
TEST(ModelState, ReinstatesWhatTheEffectExplains) {
  FittedStudy study(hiding({reversal("EYY", 1.5e-6)}, kStateGrid));
  for (const std::size_t observation : {7U, 30U, 61U}) study.result.residuals[observation].removed = true;
  const LinearModel model(study.simulated.campaign, study.result);
  const ModelState given = ModelState(model, setting_of(model)).tested();
  const ModelState reached = given.with(test_of(given, {"reversal", "EYY", "dir_y", "step"}));
  EXPECT_THAT(reached.model().removed(), ::testing::IsEmpty());
  EXPECT_THAT(given.model().removed(), ::testing::ElementsAre(7U, 30U, 61U));
}

/// One chance in a hundred of a single test is no evidence among a thousand.
TEST(ModelTests, CountsAllScans) {
  ModelTests tests;
  tests.scans.resize(1000);
  tests.scans[3].log10_p = -7.5;
  tests.scans[4].log10_p = -2.0;
  tests.scan_exceeds.assign(1000, false);
  EXPECT_FALSE(tests.any_scan_exceeds());
  tests.scan_exceeds[3] = true;
  EXPECT_TRUE(tests.any_scan_exceeds());
  EXPECT_NEAR(tests.family_wise_log10_p(tests.scans[3]), -4.5, 1e-12);
  EXPECT_EQ(tests.family_wise_log10_p(tests.scans[4]), 0.0);
  EXPECT_THAT(tests.exceeding_scans(), ::testing::ElementsAre(&tests.scans[3]));
}

}  // namespace
}  // namespace volcal
