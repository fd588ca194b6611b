// Draws solved by chord steps against refits, and what they tell where the linear path goes wrong.

#include "volcal/identify/montecarlo/chord_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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
  Campaign campaign = measured();
  FitResult result = fitted(campaign);

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
  EXPECT_LT(gradients, 64 * 4) << "its curvature is that of the draw";
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

/// Derivative of all observations to a reduced coordinate of a block, at these reduced coordinates.
Eigen::VectorXd derivative_at(const RepeatedCampaign& repeated, Eigen::Index coordinate,
                              const Eigen::VectorXd& reduced) {
  int raw = 0;
  for (const auto& block : repeated.datum().blocks()) {
    if (coordinate >= block.offset && coordinate < block.offset + block.size)
      raw = block.raw_offset + static_cast<int>(coordinate) - block.offset;
  }
  const MeasurementModel& model = repeated.linear_model().model();
  const Eigen::VectorXd parameters = repeated.datum().raw(reduced);
  Eigen::VectorXd column(repeated.observations());
  RowJacobian row;
  for (std::size_t i = 0; i < repeated.linear_model().size(); ++i) {
    const ObservationPlace& place = repeated.linear_model().observations()[i];
    if (place.channel == 0) model.linearize(place.setup, place.row, parameters, row);
    column[static_cast<Eigen::Index>(i)] = dense_row(model.layout(), row, place.channel)[raw];
  }
  return column;
}

/// What the second-order model leaves out: second derivatives to the weak parameter w and the others. A
/// centre that is w off across its plane and a machine that is e off there make the bar w e / radius shorter.
Eigen::VectorXd by_mixed_derivatives(const RepeatedCampaign& repeated, Eigen::Index weak,
                                     const Eigen::VectorXd& linear, double w) {
  Eigen::VectorXd others = linear;
  others[weak] = 0.0;
  const Eigen::VectorXd start = repeated.datum().reduced(repeated.result().parameters);
  const Eigen::VectorXd change =
      w * (derivative_at(repeated, weak, start + others) - derivative_at(repeated, weak, start));
  return -repeated.gain() *
         (repeated.linear_model().problem().jacobian.transpose() * repeated.whitener().weigh(change));
}

// The second-order model of a draw is that of the readings: its solution is much nearer than the linear one,
// and what remains is what mixed derivatives do, 9 % with these draws.
TEST(BallBarStudy, SecondOrderSolutionIsNearTheEndOfTheSteps) {
  const CircleStudy circle;
  const RepeatedCampaign repeated(circle.campaign, circle.result, {});
  const WeakParameters weak(repeated);
  const ChordSolver chord(repeated);
  ChordSolver::Workspace work(chord);
  const Eigen::ArrayXd u = repeated.gain().diagonal().cwiseSqrt();
  ASSERT_EQ(weak.size(), 1);
  double of_linear = 0.0, of_second_order = 0.0, with_mixed = 0.0;
  for (std::uint64_t number = 0; number < 8; ++number) {
    const CampaignDraw draw = repeated.draw(4, number);
    const Eigen::VectorXd linear = repeated.linear_estimates({draw});
    Eigen::MatrixXd end = linear;
    ASSERT_TRUE(chord.solve({draw}, end, work).front().converged);
    const auto distance = [&](const Eigen::VectorXd& from) {
      return ((from - end.col(0)).array() / u).abs().maxCoeff();
    };
    of_linear = std::max(of_linear, distance(linear));
    const Eigen::VectorXd second = weak.solve(draw, linear).deviation;
    of_second_order = std::max(of_second_order, distance(second));
    const Eigen::Index w = weak.which()[0];
    with_mixed =
        std::max(with_mixed, distance(second + by_mixed_derivatives(repeated, w, linear, second[w])));
  }
  EXPECT_LT(of_second_order, 0.15 * of_linear);
  EXPECT_LT(with_mixed, 0.02 * of_linear);
}

}  // namespace
}  // namespace volcal
