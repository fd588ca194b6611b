// Draws solved by chord steps against refits, and what they tell where the linear path goes wrong.

#include "volcal/identify/montecarlo/chord_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "tests/support/montecarlo_studies.h"
#include "volcal/identify/montecarlo/campaign_refit.h"
#include "volcal/identify/solve/correlated_adjustment.h"
#include "volcal/identify/solve/normals/normal_equations.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

using testing_support::studied;
using testing_support::TracerStudy;
using testing_support::value_of;

TEST_F(TracerStudy, GradientIsThatOfTheNormalEquations) {
  const RepeatedCampaign repeated(campaign(), result(), {});
  const MeasurementModel& model = repeated.linear_model().model();
  const ReadingIndex index(model);
  std::vector<double> weight;
  for (const double sigma : total_sigma(repeated.linear_model().problem().data,
                                        repeated.linear_model().stated_sigma(), repeated.noise()))
    weight.push_back(1.0 / (sigma * sigma));
  NormalAccumulator accumulator(index, weight, nullptr, 1);
  Eigen::VectorXd parameters = result().parameters;
  parameters.array() += 1e-6;
  const Eigen::VectorXd expected = accumulator.accumulate(parameters).gradient;
  Eigen::VectorXd readings(repeated.observations());
  for (std::size_t i = 0; i < repeated.linear_model().size(); ++i) {
    const ObservationPlace& place = repeated.linear_model().observations()[i];
    readings[static_cast<Eigen::Index>(i)] =
        campaign().setups[place.setup].readings.value[static_cast<std::size_t>(place.channel)][place.row];
  }
  const CampaignGradient gradient(model, repeated.whitener());
  CampaignGradient::Workspace work(gradient);
  const Eigen::VectorXd computed = gradient.at(parameters, readings, work);
  EXPECT_LT((computed - expected).norm(), 1e-9 * expected.norm());
}

/// Largest difference of the estimates of some draws from refits, in standard deviations of the parameters.
struct PathDifferences {
  double linear = 0.0;
  double chord = 0.0;
};

PathDifferences differences(const Campaign& campaign, const FitResult& result) {
  const RepeatedCampaign repeated(campaign, result, {});
  const ChordSolver chord(repeated);
  CampaignRefit refit(repeated);
  ChordSolver::Workspace work(chord);
  const Eigen::ArrayXd u = repeated.gain().diagonal().cwiseSqrt();
  PathDifferences largest;
  for (std::uint64_t number = 0; number < 5; ++number) {
    const CampaignDraw draw = repeated.draw(4, number);
    const Eigen::VectorXd linear = repeated.linear_estimates({draw});
    Eigen::MatrixXd stepped = linear;
    EXPECT_TRUE(chord.solve({draw}, stepped, work).front().converged);
    const CampaignRefit::Outcome full = refit.solve(draw);
    EXPECT_TRUE(full.converged);
    EXPECT_GT(full.deviation.norm(), 0.0);
    largest.linear = std::max(largest.linear, ((linear - full.deviation).array() / u).abs().maxCoeff());
    largest.chord = std::max(largest.chord, ((stepped.col(0) - full.deviation).array() / u).abs().maxCoeff());
  }
  return largest;
}

// A refit ends where its cost no longer tells two steps apart.
constexpr double kEndOfRefits = 1e-3;
constexpr double kOfWideRefits = 0.02;
constexpr double kOfWideEnd = 1e-3;

TEST_F(TracerStudy, PathsAgreeDrawByDraw) {
  const PathDifferences white = differences(campaign(), result());
  EXPECT_LT(white.linear, kEndOfRefits);
  EXPECT_LT(white.chord, kEndOfRefits);
}

TEST_F(TracerStudy, PathsAgreeDrawByDrawWithCorrelatedNoise) {
  const sim::SimulatedCampaign drifting = simulated(1e-6);
  const FitResult fitted = fit(drifting.campaign, {}, FitOptions{});
  ASSERT_TRUE(fitted.noise.more_than_white);
  const PathDifferences correlated = differences(drifting.campaign, fitted);
  EXPECT_LT(correlated.linear, kEndOfRefits);
  EXPECT_LT(correlated.chord, kEndOfRefits);
}

// A time constant that is estimated multiplies amplitudes, so that draws are solved one after another. Refits
// expand the effect anew about each time constant, steps keep that of the identified machine.
TEST_F(TracerStudy, PathsAgreeWhereTheShapeOfAnEffectIsEstimated) {
  ModelSpec model;
  model.effects.push_back(effect_spec("screw-heating", {{"axis", std::string("X")},
                                                        {"time_constant", 600.0},
                                                        {"time_constant_sigma", 60.0},
                                                        {"amplitude", 1e-5}}));
  const FitResult fitted = fit(campaign(), model, white_noise());
  const RepeatedCampaign repeated(campaign(), fitted, {});
  EXPECT_FALSE(StateMap::is_exact_for(repeated.linear_model().model()));
  constexpr double kOfExpansion = 0.02;
  EXPECT_LT(differences(campaign(), fitted).chord, kOfExpansion);
}

/// A tracer and a ball-bar circle in the plane XY; every error function is one cubic.
struct CircleStudy {
  static constexpr double kCircleRadius = 0.15;  // m
  Campaign campaign;
  FitResult result;

  /// The centre across the plane is known to the default, or to `sigma`, m.
  explicit CircleStudy(std::optional<double> sigma = {})
      : campaign(measured()), result(fitted(known(campaign, sigma))) {}

  static const Campaign& known(Campaign& campaign, std::optional<double> sigma) {
    for (Setup& setup : campaign.setups) {
      if (sigma && setup.instrument == "ball-bar") setup.options.set("centre_sigma", *sigma);
    }
    return campaign;
  }
  static Campaign measured() {
    sim::Study study;
    study.machine = sim::reference_machines()[0];
    study.seed = 5;
    sim::Tracking tracking;
    tracking.grid = {4, 4, 3};
    study.measurements.emplace_back().settings = tracking;
    sim::BallBarCircles circles;
    circles.planes = {"XY"};
    circles.radius = kCircleRadius;
    study.measurements.emplace_back().settings = circles;
    return sim::simulate(study).campaign;
  }
  static FitResult fitted(const Campaign& campaign) {
    ModelSpec model;
    model.default_function.knots = KnotChoice::IntervalCount;
    model.default_function.intervals = 1;
    FitOptions options;
    options.noise = NoisePolicy::White;
    return fit(campaign, model, options);
  }
};

// The centre of a circle across its plane is known to its prior alone: to first order the bar's length does
// not feel it, to second order a centre that is c off makes the bar c^2 / (2 radius) longer. Of normal c with
// standard deviation s that has mean s^2 / (2 radius) and standard deviation s^2 / (sqrt(2) radius).
TEST(BallBarStudy, CentreAcrossThePlaneBiasesTheBarsLength) {
  const CircleStudy circle;
  const PathDifferences paths = differences(circle.campaign, circle.result);
  EXPECT_LT(paths.chord, 3.0 * kEndOfRefits);
  EXPECT_GT(paths.linear, 0.1);
  const RepeatedCampaign repeated(circle.campaign, circle.result, {});
  const WeakParameters weak(repeated);
  ASSERT_EQ(weak.size(), 1) << "the centre across the plane";
  const ChordSolver chord(repeated);
  ChordSolver::Workspace work(chord);
  std::vector<CampaignDraw> draws;
  for (std::uint64_t number = 0; number < 64; ++number) draws.push_back(repeated.draw(4, number));
  Eigen::MatrixXd deviations = repeated.linear_estimates(draws);
  int gradients = 0;
  for (const ChordSolver::Outcome& outcome : chord.solve(draws, deviations, work)) {
    EXPECT_TRUE(outcome.converged);
    gradients += outcome.gradients;
  }
  EXPECT_LT(gradients, 64 * 2) << "its curvature is that of the draw";
  MonteCarloOptions options;
  options.path = DrawPath::Chord;
  options.draws = 4000;
  options.threads = 2;
  const MonteCarloResult study = studied(circle.campaign, circle.result, options);
  EXPECT_EQ(study.not_converged, 0U);
  const double s = value_of(study, "ballbar_XY: centre z").u_linear;
  const QuantityResult& length = value_of(study, "ballbar_XY: bar length error");
  EXPECT_NEAR(std::abs(length.bias), s * s / (2.0 * CircleStudy::kCircleRadius), 5.0 * length.bias_error);
  const double squares = length.u_linear * length.u_linear +
                         std::pow(s * s / (std::numbers::sqrt2 * CircleStudy::kCircleRadius), 2);
  EXPECT_NEAR(length.u / std::sqrt(squares), 1.0, 0.1);
  EXPECT_EQ(length.verdict, LinearVerdict::NotValidated);
}

// The second-order model of a draw is that of the readings: the squares of the weak parameter and its
// products with the others. Squares alone end 9 % of the way short.
TEST(BallBarStudy, SecondOrderSolutionIsNearTheEndOfTheSteps) {
  const CircleStudy circle;
  const RepeatedCampaign repeated(circle.campaign, circle.result, {});
  const WeakParameters weak(repeated);
  const ChordSolver chord(repeated);
  ChordSolver::Workspace work(chord);
  const Eigen::ArrayXd u = repeated.gain().diagonal().cwiseSqrt();
  ASSERT_EQ(weak.size(), 1);
  double of_linear = 0.0, of_second_order = 0.0;
  for (std::uint64_t number = 0; number < 8; ++number) {
    const CampaignDraw draw = repeated.draw(4, number);
    const Eigen::VectorXd linear = repeated.linear_estimates({draw});
    Eigen::MatrixXd end = linear;
    ASSERT_TRUE(chord.solve({draw}, end, work).front().converged);
    const auto distance = [&](const Eigen::VectorXd& from) {
      return ((from - end.col(0)).array() / u).abs().maxCoeff();
    };
    of_linear = std::max(of_linear, distance(linear));
    of_second_order = std::max(of_second_order, distance(weak.solve(draw, linear).deviation));
  }
  EXPECT_LT(of_second_order, 0.01 * of_linear);
}

/// Length of the Newton step that is left at a point, standard deviations; the gradient reading by reading.
double newton_step(const RepeatedCampaign& repeated, const WeakParameters& weak, const CampaignDraw& draw,
                   const Eigen::VectorXd& linear, const Eigen::VectorXd& deviation) {
  const CampaignGradient of_readings(repeated.linear_model().model(), repeated.whitener());
  CampaignGradient::Workspace work(of_readings);
  const Eigen::VectorXd raw = repeated.datum().raw(repeated.identified() + deviation);
  const Eigen::VectorXd gradient =
      repeated.datum().reduce_gradient(of_readings.at(raw, repeated.predicted() + draw.errors, work)) +
      repeated.prior_precision() * (deviation - draw.statement);
  return std::sqrt(std::max(0.0, gradient.dot(weak.inverse_curvature(weak.solve(draw, linear), gradient,
                                                                     repeated.gain() * gradient))));
}

// A centre that is known to a millimetre: the bar's length follows c^2 / (2 radius), 3.3 um of a length that
// is known to some 0.1 um, along a valley that bends by more than ten standard deviations.
TEST(BallBarStudy, WidePriorTakesFewGradients) {
  constexpr double kWide = 1e-3;
  const CircleStudy circle(kWide);
  const RepeatedCampaign repeated(circle.campaign, circle.result, {});
  const WeakParameters weak(repeated);
  ASSERT_EQ(weak.size(), 1);
  const ChordSolver chord(repeated);
  ChordSolver::Workspace work(chord);
  const std::vector<CampaignDraw> draws = repeated.draws(4, 0, 64);
  Eigen::MatrixXd deviations = repeated.linear_estimates(draws);
  int gradients = 0;
  const Eigen::MatrixXd linear = deviations;
  for (const ChordSolver::Outcome& outcome : chord.solve(draws, deviations, work)) {
    EXPECT_TRUE(outcome.converged);
    gradients += outcome.gradients;
  }
  EXPECT_LT(gradients, 64 * 3);
  const Eigen::ArrayXd u = repeated.gain().diagonal().cwiseSqrt();
  EXPECT_GT(((deviations - linear).array().colwise() / u).abs().maxCoeff(), 10.0);
  for (std::size_t k = 0; k < draws.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    EXPECT_LT(newton_step(repeated, weak, draws[k], linear.col(column), deviations.col(column)), kOfWideEnd);
  }
  CampaignRefit refit(repeated);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const CampaignRefit::Outcome full = refit.solve(draws[static_cast<std::size_t>(k)]);
    EXPECT_TRUE(full.converged);
    EXPECT_LT(((deviations.col(k) - full.deviation).array() / u).abs().maxCoeff(), kOfWideRefits);
  }
}

}  // namespace
}  // namespace volcal
