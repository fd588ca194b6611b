// Monte Carlo studies of campaigns whose uncertainties are known by hand or by the fit, the three paths
// against each other, and the same bits for any number of threads and after an interruption.

#include "volcal/identify/montecarlo/montecarlo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <barrier>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <string>
#include <thread>

#include "volcal/identify/montecarlo/campaign_refit.h"
#include "volcal/identify/montecarlo/chord_solver.h"
#include "volcal/identify/solve/correlated_adjustment.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/solve/normal_equations.h"
#include "volcal/identify/tables/error_tables.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/sim/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

constexpr double kNoise = 1e-6;    // m
constexpr double kScale = 0.5e-6;  // relative
const std::vector<double> kPositions = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8};

/// Four lines along X of one laser whose scale has a standard uncertainty; EXX is a straight line.
struct LinesOfOneLaser {
  Campaign campaign;
  ModelSpec model;
  FitOptions options;

  LinesOfOneLaser() {
    campaign.file = "campaign.toml";
    campaign.machine = sim::machine_from_code("w X b Y Z t", {{{0.0, 1.0}, {0.0, 0.6}, {0.0, 0.5}}});
    campaign.machine.tools = {{"long", {0.0, 0.0, -0.2}, 0.0}};
    for (const char* name : {"L1", "L2", "L3", "L4"}) campaign.setups.push_back(line(name));
    model.default_function.basis = "zero";
    FunctionSpec& straight = model.functions[*ErrorSymbol::parse("EXX")];
    straight.basis = "legendre";
    straight.degree = 1;
    for (const LocationSymbol symbol : campaign.machine.datum.squareness())
      model.locations_off.push_back(symbol);
    options.variance_components = false;
  }

  static Setup line(const std::string& name) {
    Setup setup;
    setup.name = name;
    setup.instrument = "displacement";
    setup.noise.set("constant", kNoise);
    setup.has_noise = true;
    setup.options.set("direction", Eigen::Vector3d(1.0, 0.0, 0.0));
    setup.options.set("scale_sigma", kScale);
    setup.options.set("scale_group", std::string("laser"));
    setup.readings.value.emplace_back();
    for (const double x : kPositions) {
      setup.readings.position[0].push_back(x);
      setup.readings.position[1].push_back(0.0);
      setup.readings.position[2].push_back(0.0);
      setup.readings.value[0].push_back(x - kPositions[0]);
      setup.readings.source_line.push_back(static_cast<std::int64_t>(setup.readings.source_line.size()) + 2);
    }
    return setup;
  }

  /// reading = a x + scale x + offset: var(a) = scale^2 + noise^2 / sum (x - mean)^2.
  static double slope_u() {
    double squares = 0.0;
    for (const double x : kPositions) squares += 4.0 * (x - 0.45) * (x - 0.45);
    return std::sqrt(kScale * kScale + kNoise * kNoise / squares);
  }
};

MonteCarloResult studied(const Campaign& campaign, const FitResult& result,
                         const MonteCarloOptions& options) {
  MonteCarloStudy study(campaign, result, options);
  while (!study.done()) study.run_block();
  return study.result();
}

const QuantityResult& value_of(const MonteCarloResult& result, const std::string& words) {
  for (const QuantityResult& value : result.quantities) {
    if (value.quantity.words() == words) return value;
  }
  throw std::out_of_range(words);
}

class HandWorked : public ::testing::TestWithParam<DrawPath> {};

// 20,000 draws know a standard uncertainty to 0.5 %; the scale does not average away.
TEST_P(HandWorked, SlopeOfLinesWithASharedScale) {
  const LinesOfOneLaser lines;
  const FitResult result = fit(lines.campaign, lines.model, lines.options);
  MonteCarloOptions options;
  options.path = GetParam();
  options.draws = GetParam() == DrawPath::Refit ? 4000 : 20000;
  options.threads = 2;
  const MonteCarloResult study = studied(lines.campaign, result, options);
  EXPECT_EQ(study.path, GetParam());
  EXPECT_EQ(study.not_converged, 0U);
  const double error = 4.0 * std::sqrt(0.5 / static_cast<double>(options.draws));
  const QuantityResult& end = value_of(study, "EXX at 1000 mm");
  EXPECT_NEAR(end.u_linear / LinesOfOneLaser::slope_u(), 1.0, 1e-6);
  EXPECT_NEAR(end.u / LinesOfOneLaser::slope_u(), 1.0, error);
  EXPECT_NEAR((end.symmetric.high - end.quantity.estimate) / LinesOfOneLaser::slope_u(), 1.96, 6.0 * error);
  EXPECT_LT(std::abs(end.bias), 4.0 * end.bias_error);
  EXPECT_NE(end.verdict, LinearVerdict::NotValidated);
}

INSTANTIATE_TEST_SUITE_P(Paths, HandWorked,
                         ::testing::Values(DrawPath::Linear, DrawPath::Chord, DrawPath::Refit),
                         [](const auto& tested) { return std::string(to_string(tested.param)); });

// A wrong scale moves the slope by itself; noise by its share in the regression.
TEST(Budget, SlopeOfLinesWithASharedScale) {
  const LinesOfOneLaser lines;
  const FitResult result = fit(lines.campaign, lines.model, lines.options);
  MonteCarloOptions options;
  options.draws = 1000;
  options.refits = 0;
  options.path = DrawPath::Linear;
  options.sources.disturbances.push_back(
      {effect_spec("length-scale", {{"target", std::string("readings")}}), 0.2e-6, "length scale unknown"});
  const MonteCarloResult study = studied(lines.campaign, result, options);
  const auto value = std::ranges::find_if(
      study.quantities, [](const QuantityResult& each) { return each.quantity.words() == "EXX at 1000 mm"; });
  const Eigen::Index row = value - study.quantities.begin();
  std::map<std::string, double> u;
  for (std::size_t s = 0; s < study.budget.sources.size(); ++s)
    u[study.budget.sources[s]] += study.budget.u(row, static_cast<Eigen::Index>(s));
  const double noise = std::sqrt(std::pow(LinesOfOneLaser::slope_u(), 2) - kScale * kScale);
  EXPECT_NEAR(u.at("noise of displacement") / noise, 1.0, 1e-6);
  EXPECT_NEAR(u.at("prior of length scale laser") / kScale, 1.0, 1e-6);
  EXPECT_NEAR(u.at("length scale unknown") / 0.2e-6, 1.0, 1e-6);
  const auto scale = std::ranges::find(study.budget.sources, "prior of length scale laser");
  const double halved =
      study.budget.u_with_half_of(static_cast<std::size_t>(scale - study.budget.sources.begin()))[row];
  EXPECT_NEAR(halved / std::sqrt(noise * noise + 0.25 * kScale * kScale + 0.04e-12), 1.0, 1e-6);
}

/// Readings of a tracer on a grid; its fit with smoothed functions.
class TracerStudy : public ::testing::Test {
 protected:
  static sim::SimulatedCampaign simulated(double wander) {
    sim::Study study;
    study.machine = sim::reference_machines()[1];
    study.seed = 21;
    sim::Tracking tracking;
    tracking.grid = {5, 4, 4};
    tracking.noise.wander = wander;
    tracking.noise.wander_time = 200.0;
    study.measurements.emplace_back().settings = tracking;
    study.validation.points = 5;
    return sim::simulate(study);
  }

  static FitOptions white_noise() {
    FitOptions options;
    options.noise = NoisePolicy::White;
    return options;
  }
  static const Campaign& campaign() {
    static const sim::SimulatedCampaign kSimulated = simulated(0.0);
    return kSimulated.campaign;
  }
  static const FitResult& result() {
    static const FitResult kResult = fit(campaign(), {}, white_noise());
    return kResult;
  }
};

// To 0.5 %: a smoothing precision is singular for straight lines to rounding alone, which so few readings
// feel.
TEST_F(TracerStudy, LinearPropagationIsTheCovarianceOfTheFit) {
  const RepeatedCampaign repeated(campaign(), result(), {});
  const Eigen::MatrixXd covariance = repeated.datum().expand_covariance(repeated.linear_covariance());
  for (const ErrorTableRow& row : error_table(result())) ASSERT_GE(row.u, 0.0);
  const Eigen::MatrixXd rows = error_table_derivatives(result());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const double fitted = rows.row(i).dot(result().covariance * rows.row(i).transpose());
    const double drawn = rows.row(i).dot(covariance * rows.row(i).transpose());
    EXPECT_NEAR(std::sqrt(drawn), std::sqrt(fitted), 5e-3 * std::sqrt(fitted) + 1e-12) << i;
  }
}

TEST_F(TracerStudy, ContributionsOfTheBudgetAddUp) {
  MonteCarloOptions options;
  options.draws = 1000;
  options.refits = 0;
  options.path = DrawPath::Linear;
  const MonteCarloResult study = studied(campaign(), result(), options);
  const Eigen::VectorXd sum = study.budget.u.rowwise().norm();
  ASSERT_GE(study.budget.sources.size(), 3U);
  for (std::size_t i = 0; i < study.quantities.size(); ++i) {
    const QuantityResult& value = study.quantities[i];
    EXPECT_NEAR(sum[static_cast<Eigen::Index>(i)], value.u_linear, 1e-6 * value.u_linear + 1e-15)
        << value.quantity.words();
  }
}

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
  CampaignGradient::Workspace work(chord.gradient());
  const Eigen::ArrayXd u = repeated.gain().diagonal().cwiseSqrt();
  PathDifferences largest;
  for (std::uint64_t number = 0; number < 5; ++number) {
    const CampaignDraw draw = repeated.draw(4, number);
    const Eigen::VectorXd linear = repeated.linear_estimates({draw});
    Eigen::VectorXd stepped = linear;
    EXPECT_TRUE(chord.solve(draw, stepped, work).converged);
    const CampaignRefit::Outcome full = refit.solve(draw);
    EXPECT_TRUE(full.converged);
    EXPECT_GT(full.deviation.norm(), 0.0);
    largest.linear = std::max(largest.linear, ((linear - full.deviation).array() / u).abs().maxCoeff());
    largest.chord = std::max(largest.chord, ((stepped - full.deviation).array() / u).abs().maxCoeff());
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
  const sim::SimulatedCampaign wandering = simulated(1e-6);
  const FitResult fitted = fit(wandering.campaign, {}, FitOptions{});
  ASSERT_TRUE(fitted.noise.more_than_white);
  const PathDifferences correlated = differences(wandering.campaign, fitted);
  EXPECT_LT(correlated.linear, kEndOfRefits);
  EXPECT_LT(correlated.chord, kEndOfRefits);
}

/// A tracer and a ball-bar circle in the plane XY; every error function is one cubic.
struct CircleStudy {
  static constexpr double kRadius = 0.15;  // m
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
    circles.radius = kRadius;
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
  MonteCarloOptions options;
  options.path = DrawPath::Chord;
  options.draws = 4000;
  options.threads = 2;
  const MonteCarloResult study = studied(circle.campaign, circle.result, options);
  EXPECT_EQ(study.not_converged, 0U);
  const double s = value_of(study, "ballbar_XY: centre z").u_linear;
  const QuantityResult& length = value_of(study, "ballbar_XY: bar length error");
  EXPECT_NEAR(std::abs(length.bias), s * s / (2.0 * CircleStudy::kRadius), 5.0 * length.bias_error);
  const double squares =
      length.u_linear * length.u_linear + std::pow(s * s / (std::numbers::sqrt2 * CircleStudy::kRadius), 2);
  EXPECT_NEAR(length.u / std::sqrt(squares), 1.0, 0.1);
  EXPECT_EQ(length.verdict, LinearVerdict::NotValidated);
}

// Whatever the thread, the sums are the same to the bit.
TEST_F(TracerStudy, ThreadsDoNotChangeABit) {
  for (const DrawPath path : {DrawPath::Linear, DrawPath::Chord, DrawPath::Refit}) {
    std::string one;
    for (const int threads : {1, 3}) {
      MonteCarloOptions options;
      options.path = path;
      options.threads = threads;
      options.refits = 2;
      options.draws = path == DrawPath::Linear ? 12000 : path == DrawPath::Chord ? 1100 : 12;
      MonteCarloStudy study(campaign(), result(), options);
      while (!study.done()) study.run_block();
      EXPECT_EQ(study.draws(), options.draws);
      if (threads == 1) one = study.save();
      EXPECT_EQ(study.save(), one) << to_string(path) << ", " << threads << " threads";
    }
  }
}

/// Two ranks as two threads of this process.
class TwoRanks {
 public:
  class Rank final : public DrawTeam {
   public:
    Rank(TwoRanks& both, std::size_t rank) : both_(both), rank_(rank) {}
    std::size_t rank() const override { return rank_; }
    std::size_t size() const override { return 2; }
    std::vector<std::string> gather(const std::string& own) override {
      both_.given_[rank_] = own;
      both_.all_here_.arrive_and_wait();
      std::vector<std::string> all(both_.given_.begin(), both_.given_.end());
      both_.all_here_.arrive_and_wait();
      return all;
    }

   private:
    TwoRanks& both_;
    std::size_t rank_;
  };

 private:
  std::array<std::string, 2> given_;
  std::barrier<> all_here_{2};
};

TEST_F(TracerStudy, RanksDoNotChangeABit) {
  for (const DrawPath path : {DrawPath::Linear, DrawPath::Chord}) {
    MonteCarloOptions options;
    options.path = path;
    options.refits = 1;
    options.threads = 1;
    options.draws = path == DrawPath::Linear ? 20250 : 1010;  // a last block of one batch
    MonteCarloStudy alone(campaign(), result(), options);
    while (!alone.done()) alone.run_block();
    TwoRanks ranks;
    std::array<std::string, 2> states;
    const auto run = [&](std::size_t rank) {
      TwoRanks::Rank team(ranks, rank);
      MonteCarloOptions own = options;
      own.team = &team;
      MonteCarloStudy study(campaign(), result(), own);
      while (!study.done()) study.run_block();
      states[rank] = study.save();
    };
    std::thread other(run, 1);
    run(0);
    other.join();
    EXPECT_EQ(states[0], alone.save()) << to_string(path);
    EXPECT_EQ(states[1], alone.save()) << to_string(path);
  }
}

TEST_F(TracerStudy, RanksThatComputeOtherNumbersAreRefused) {
  TwoRanks ranks;
  const auto refused = [&](std::size_t rank) {
    TwoRanks::Rank team(ranks, rank);
    MonteCarloOptions own;
    own.path = DrawPath::Linear;
    own.refits = 0;
    own.seed = 1 + rank;
    own.team = &team;
    EXPECT_THROW(MonteCarloStudy(campaign(), result(), own), InputError);
  };
  std::thread other(refused, 1);
  refused(0);
  other.join();
}

TEST_F(TracerStudy, ResumedStudyIsTheUninterruptedOne) {
  MonteCarloOptions options;
  options.path = DrawPath::Linear;
  options.draws = 35000;
  options.refits = 1;
  MonteCarloStudy whole(campaign(), result(), options), interrupted(campaign(), result(), options),
      resumed(campaign(), result(), options);
  while (!whole.done()) whole.run_block();
  interrupted.run_block();
  interrupted.run_block();
  EXPECT_EQ(resumed.fingerprint(), interrupted.fingerprint());
  resumed.restore(interrupted.save());
  EXPECT_EQ(resumed.draws(), 20000U);
  while (!resumed.done()) resumed.run_block();
  EXPECT_EQ(resumed.save(), whole.save());
}

TEST_F(TracerStudy, StateOfAnotherStudyIsRefused) {
  MonteCarloOptions options;
  options.refits = 1;
  options.draws = 10000;
  MonteCarloStudy study(campaign(), result(), options);
  options.seed = 2;
  EXPECT_NE(MonteCarloStudy(campaign(), result(), options).fingerprint(), study.fingerprint());
  EXPECT_THROW(study.restore("abc"), std::invalid_argument);
  EXPECT_THROW(study.restore(study.save() + "x"), std::invalid_argument);
}

// Every table value of 40,000 linear and of 4,000 nonlinear draws against linear propagation.
TEST_F(TracerStudy, MonteCarloAgreesWithTheTables) {
  for (const auto& [path, draws] : {std::pair(DrawPath::Linear, 40000), std::pair(DrawPath::Chord, 4000)}) {
    MonteCarloOptions options;
    options.path = path;
    options.draws = static_cast<std::uint64_t>(draws);
    options.threads = 2;
    const MonteCarloResult study = studied(campaign(), result(), options);
    const double error = 5.0 * std::sqrt(0.5 / draws);
    for (const QuantityResult& value : study.quantities) {
      if (value.quantity.kind != QuantityKind::TableValue) continue;
      EXPECT_NEAR(value.u / value.u_linear, 1.0, error) << value.quantity.words();
    }
  }
}

// Scatter of repeated campaigns on one machine and the bias of smoothing, both smaller than the uncertainty
// of the tables, which covers the two on average over machines.
TEST_F(TracerStudy, FixedFunctionsTellScatterAndBiasApart) {
  MonteCarloOptions options;
  options.path = DrawPath::Chord;
  options.draws = 4000;
  options.threads = 2;
  options.sources.functions = FunctionRoughness::Fixed;
  const MonteCarloResult study = studied(campaign(), result(), options);
  MonteCarloOptions drawn = options;
  drawn.sources.functions = FunctionRoughness::Drawn;
  drawn.path = DrawPath::Linear;
  const MonteCarloResult all = studied(campaign(), result(), drawn);
  double biased = 0.0;
  for (std::size_t i = 0; i < study.quantities.size(); ++i) {
    const QuantityResult& value = study.quantities[i];
    if (value.quantity.kind != QuantityKind::TableValue) continue;
    EXPECT_LE(value.u_linear, all.quantities[i].u_linear * (1.0 + 1e-9)) << value.quantity.words();
    EXPECT_NEAR(value.bias, value.bias_linear, 5.0 * value.bias_error + 0.02 * value.u)
        << value.quantity.words();
    biased = std::max(biased, std::abs(value.bias_linear) / value.u);
  }
  EXPECT_GT(biased, 0.1);
}

TEST_F(TracerStudy, AdaptiveStudyEndsWhenEveryFigureHasSettled) {
  MonteCarloOptions options;
  options.digits = 1;
  options.grid_per_axis = 0;
  options.threads = 2;
  const MonteCarloResult study = studied(campaign(), result(), options);
  EXPECT_TRUE(study.settled);
  EXPECT_EQ(study.draws % StudySums::kSequence, 0U);
  for (const QuantityResult& value : study.quantities)
    EXPECT_LT(value.scatter, value.tolerance) << value.quantity.words();
}

TEST(MonteCarlo, RefusesWhatTheReadingsDoNotDetermine) {
  LinesOfOneLaser lines;
  lines.model.functions[*ErrorSymbol::parse("EYX")] = lines.model.functions[*ErrorSymbol::parse("EXX")];
  lines.model.functions[*ErrorSymbol::parse("EYX")].degree = 3;
  const FitResult result = fit(lines.campaign, lines.model, lines.options);
  ASSERT_EQ(result.status, FitStatus::RankDeficient);
  EXPECT_THROW(MonteCarloStudy(lines.campaign, result, {}), InputError);
}

}  // namespace
}  // namespace volcal
