// Effects that imitate correlated drift, with the noise estimated beside them. Readings are drawn.

#include "volcal/identify/criticism/search/joint_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/search_states.h"
#include "volcal/identify/statistics/chi_squared.h"

namespace volcal {
namespace {

using testing_support::families_of;
using testing_support::model_of_nothing_hidden;
using testing_support::white_residual;

/// A displacement that swings with the square of the position changes slowly along the path, as correlated
/// drift does.
class JointNoise : public ::testing::Test {
 protected:
  JointNoise() : families_(families_of(model(), "station-drift", "station P1")), problem_(model().problem()) {
    problem_.prior_mean.setZero();
  }

  static const LinearModel& model() { return model_of_nothing_hidden(); }
  const Family& family() const { return families_.at(0); }
  Eigen::MatrixXd columns() const { return family_columns(model(), family(), Eigen::VectorXd()); }

  NoiseEstimate estimate(const Eigen::VectorXd& residual) {
    problem_.residual = residual;
    NoiseOptions options;
    options.uncertainty = false;
    return estimate_noise(problem_, options);
  }

  FamilyTest tested_at(const std::vector<NoiseParameters>& noise) const {
    const Projector projector(problem_, problem_.data, noise, 1, model().parts());
    return test_families(model(), families_, projector, 1).at(0);
  }

  std::vector<Family> families_;
  NoiseProblem problem_;
};

TEST_F(JointNoise, NothingToDoWhereNothingDrifts) {
  std::mt19937_64 random(8);
  const NoiseEstimate noise = estimate(white_residual(model(), random));
  ASSERT_EQ(noise.instruments.at(0).parameters.drift, 0.0);
  JointLikelihood likelihood(problem_, 1);
  EXPECT_TRUE(noise_with_reduced_drift(likelihood, noise).empty());
}

TEST_F(JointNoise, FindsWhatADriftHasTakenUp) {
  std::mt19937_64 random(8);
  const Eigen::VectorXd white = white_residual(model(), random);
  Eigen::VectorXd amplitude(3);
  amplitude << 1.0, -0.7, 0.5;
  Eigen::VectorXd moved = columns() * amplitude;
  moved *= 1.5 * white.norm() / moved.norm();
  const NoiseEstimate noise = estimate(white + moved);
  ASSERT_GT(noise.instruments.at(0).parameters.drift, 0.0);
  JointLikelihood likelihood(problem_, 1);
  const auto alternatives = noise_with_reduced_drift(likelihood, noise);
  ASSERT_EQ(alternatives.size(), 1U);
  EXPECT_LT(alternatives[0].noise[0].drift, 0.5 * noise.instruments.at(0).parameters.drift);
  EXPECT_GT(alternatives[0].loss, 0.0);
  FamilyTest test = tested_at(alternatives[0].noise);
  const double bound = test.score.lm - alternatives[0].loss;
  EXPECT_GT(bound, 0.0);
  test_jointly(model(), family(), likelihood, noise, {}, 0.0, test);
  EXPECT_GE(test.score.lm, bound - 0.1);
  EXPECT_LT(test.log10_p, tested_at(noise.parameters()).log10_p);
  EXPECT_LT(test.log10_p, -6.0);
  EXPECT_GT(test.log10_p, log10_chi_squared_exceedance(test.score.lm, 3) + 1.0)
      << "correlated drift is known from its correlation times";
  const double ratio = test.score.lm;
  test_jointly(model(), family(), likelihood, noise, {}, 2.0 * ratio, test);
  EXPECT_GE(test.score.lm, ratio) << "an upper bound will do";
  EXPECT_LT(test.score.lm, 2.0 * ratio);
}

/// A ball-bar's servo mismatch moves no reading of the tracer beside it, whose noise drifts; the bar's is
/// white, and known from all its readings.
TEST(JointNoiseOfSeveral, StandsOnTheNoiseOfThoseThatAreMoved) {
  sim::Study study = testing_support::hiding({}, {5, 4, 3});
  sim::BallBarCircles circles;
  circles.planes = {"XY"};
  circles.records_feed = true;
  study.measurements.emplace_back().settings = circles;
  const testing_support::FittedStudy fitted(study);
  NoiseProblem problem = fitted.model.problem();
  problem.prior_mean.setZero();
  std::mt19937_64 random(10);
  problem.residual = white_residual(fitted.model, random);
  const auto groups = fitted.model.noise_groups();
  const auto tracer = static_cast<std::size_t>(std::ranges::find(groups, "ball-bar") == groups.begin());
  for (const NoiseSequence& sequence : problem.data.sequences) {
    if (sequence.group != tracer) continue;
    for (std::size_t k = 0; k < sequence.observation.size(); ++k)
      problem.residual[static_cast<Eigen::Index>(sequence.observation[k])] +=
          2e-6 * std::sin(sequence.time[k] / 300.0);
  }
  NoiseOptions options;
  options.uncertainty = false;
  const NoiseEstimate noise = estimate_noise(problem, options);
  ASSERT_GT(noise.instruments.at(tracer).parameters.drift, 0.0);
  const InstrumentNoise& bar = noise.instruments.at(1 - tracer);
  ASSERT_FALSE(bar.drift.on || bar.line.on || bar.per_metre.on);

  const std::vector<Family> servo = families_of(fitted.model, "servo-mismatch");
  const Projector projector(problem, problem.data, noise.parameters(), 1, fitted.model.parts());
  FamilyTest test = test_families(fitted.model, servo, projector, 1).at(0);
  JointLikelihood likelihood(problem, 1);
  test_jointly(fitted.model, servo.at(0), likelihood, noise, {}, 0.0, test);
  const auto readings = static_cast<double>(bar.observations);
  EXPECT_GE(test.score.log10_p, log10_chi_squared_exceedance(test.score.lm, test.score.dof));
  EXPECT_LE(test.score.log10_p, log10_exceedance_of_estimated(test.score.lm, test.score.dof, 0.5 * readings));
}

/// Under true correlated drift the ratio of an effect that is not there is chi-squared with its three
/// amplitudes.
TEST_F(JointNoise, StaysWithinChanceUnderATrueDrift) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  constexpr int kDraws = 12;
  constexpr double kTau = 600.0;
  int drifting = 0;
  double ratios = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    Eigen::VectorXd residual = white_residual(model(), random);
    for (const NoiseSequence& sequence : problem_.data.sequences) {
      double drift = 0.6e-6 * normal(random);
      for (std::size_t k = 0; k < sequence.observation.size(); ++k) {
        if (k > 0) {
          const double kept = std::exp(-(sequence.time[k] - sequence.time[k - 1]) / kTau);
          drift = kept * drift + 0.6e-6 * std::sqrt(1.0 - kept * kept) * normal(random);
        }
        residual[static_cast<Eigen::Index>(sequence.observation[k])] += drift;
      }
    }
    const NoiseEstimate noise = estimate(residual);
    if (noise.instruments.at(0).parameters.drift == 0.0) continue;
    ++drifting;
    FamilyTest test = tested_at(noise.parameters());
    JointLikelihood likelihood(problem_, 1);
    test_jointly(model(), family(), likelihood, noise, {}, 0.0, test);
    ratios += test.score.lm;
  }
  ASSERT_GT(drifting, kDraws / 2);
  EXPECT_LT(ratios / drifting, 3.0 + 3.1 * std::sqrt(6.0 / drifting));
  EXPECT_GT(ratios / drifting, 0.5);
}

/// On one circle a drift of a few seconds follows a servo mismatch as well as its own shape does.
TEST(JointNoiseTestOfAState, FindsTheEffectThatDriftHasAbsorbed) {
  sim::HiddenEffect servo{.kind = "servo-mismatch", .options = {}, .rms = 0.5e-6};
  servo.options.set("axis", "X");
  sim::Study study = testing_support::hiding({servo}, {5, 4, 4});
  sim::BallBarCircles circles;
  circles.planes = {"XY"};
  circles.records_feed = true;
  study.measurements.emplace_back().settings = circles;
  const testing_support::FittedStudy fitted(study);
  const ModelState state = ModelState(fitted.model, testing_support::setting_of(fitted.model)).tested();
  const JointNoiseTest joint(state);
  const auto effect = joint.effect([&](const FamilyTest& test) { return test.score.dof > 0; });
  ASSERT_TRUE(effect.has_value());
  EXPECT_EQ(state.setting().families[effect->family].name().kind, "servo-mismatch");
  EXPECT_FALSE(joint.effect([](const FamilyTest&) { return false; }).has_value());
}

TEST(JointNoiseTestOfAState, ChangesNothingWhereNothingIsHidden) {
  const LinearModel& model = model_of_nothing_hidden();
  const ModelState state = ModelState(model, testing_support::setting_of(model)).tested();
  const JointNoiseTest joint(state);
  EXPECT_FALSE(joint.effect([](const FamilyTest& test) { return test.score.dof > 0; }).has_value());
}

}  // namespace
}  // namespace volcal
