// Monte Carlo studies of campaigns whose uncertainties are known by hand or by the fit, and the same bits for
// any number of threads and after an interruption.

#include "volcal/identify/montecarlo/montecarlo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <barrier>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/support/long_tests.h"
#include "tests/support/montecarlo_studies.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

using testing_support::studied;
using testing_support::TracerStudy;
using testing_support::value_of;

constexpr double kNoiseOfLines = 1e-6;    // m
constexpr double kScaleOfLaser = 0.5e-6;  // relative
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
    setup.noise.set("constant", kNoiseOfLines);
    setup.has_noise = true;
    setup.options.set("direction", Eigen::Vector3d(1.0, 0.0, 0.0));
    setup.options.set("scale_sigma", kScaleOfLaser);
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
    return std::sqrt(kScaleOfLaser * kScaleOfLaser + kNoiseOfLines * kNoiseOfLines / squares);
  }
};

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
  const double noise = std::sqrt(std::pow(LinesOfOneLaser::slope_u(), 2) - kScaleOfLaser * kScaleOfLaser);
  EXPECT_NEAR(u.at("noise of displacement") / noise, 1.0, 1e-6);
  EXPECT_NEAR(u.at("prior of length scale laser") / kScaleOfLaser, 1.0, 1e-6);
  EXPECT_NEAR(u.at("length scale unknown") / 0.2e-6, 1.0, 1e-6);
  const auto scale = std::ranges::find(study.budget.sources, "prior of length scale laser");
  const double halved =
      study.budget.u_with_half_of(static_cast<std::size_t>(scale - study.budget.sources.begin()))[row];
  EXPECT_NEAR(halved / std::sqrt(noise * noise + 0.25 * kScaleOfLaser * kScaleOfLaser + 0.04e-12), 1.0, 1e-6);
}

// To 0.5 %: a smoothing precision is singular for straight lines to rounding alone, which so few readings
// feel.
TEST_F(TracerStudy, LinearPropagationIsTheCovarianceOfTheFit) {
  const RepeatedCampaign repeated(campaign(), result(), {});
  const Eigen::MatrixXd normal = repeated.linear_root() * repeated.linear_root().transpose();
  const Eigen::MatrixXd rectangular = repeated.response() * repeated.response().transpose();
  const Eigen::MatrixXd covariance = repeated.datum().expand_covariance(normal + rectangular);
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

// Whatever the thread, the sums are the same to the bit.
TEST_F(TracerStudy, ThreadsDoNotChangeABit) {
  for (const DrawPath path : {DrawPath::Linear, DrawPath::Chord, DrawPath::Refit}) {
    std::string one;
    for (const int threads : {1, 3}) {
      MonteCarloOptions options;
      options.path = path;
      options.threads = threads;
      options.refits = 2;
      options.grid_per_axis = 2;
      options.draws = path == DrawPath::Linear ? 12000 : path == DrawPath::Chord ? 1300 : 12;
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
  VOLCAL_FOR_THE_NIGHT("the test mpi, whose two ranks write the files of one process");
  for (const DrawPath path : {DrawPath::Linear, DrawPath::Chord}) {
    MonteCarloOptions options;
    options.path = path;
    options.refits = 1;
    options.threads = 1;
    options.grid_per_axis = 2;
    options.draws = path == DrawPath::Linear ? 20250 : 1260;  // a last block of one batch
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
  options.grid_per_axis = 2;
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
    options.grid_per_axis = 0;
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
  options.grid_per_axis = 0;
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

/// Of one draw there is no scatter, of a few too little to reject anything.
TEST_F(TracerStudy, FewLinearDrawsDecideNothing) {
  for (const std::uint64_t draws : {1U, 2U, 3U, 100U}) {
    MonteCarloOptions options;
    options.path = DrawPath::Linear;
    options.refits = 0;
    options.draws = draws;
    options.grid_per_axis = 0;
    const MonteCarloResult study = studied(campaign(), result(), options);
    for (const QuantityResult& value : study.quantities) {
      EXPECT_NE(value.verdict, LinearVerdict::NotValidated) << draws << value.quantity.words();
      EXPECT_EQ(std::isnan(value.u), draws == 1) << draws << value.quantity.words();
      if (draws < kFewestForEnds) {
        EXPECT_EQ(value.verdict, LinearVerdict::Undecided) << value.quantity.words();
      }
    }
  }
}

TEST_F(TracerStudy, EndsAtItsMostDrawsAndForecastsMore) {
  MonteCarloOptions options;
  options.path = DrawPath::Linear;
  options.refits = 0;
  options.grid_per_axis = 0;
  options.most_draws = 12345;
  const MonteCarloResult study = studied(campaign(), result(), options);
  EXPECT_EQ(study.draws, 12345U);
  EXPECT_FALSE(study.settled);
  EXPECT_GE(study.would_settle, 2 * StudySums::kSequence);
}

// Four draws of +-0: their own scatter is nothing, that of linear propagation 2.67 / sqrt(4).
TEST(StudySums, EndsOfAFewDrawsScatterAsLinearPropagationSays) {
  StudySums sums(1);
  const Eigen::ArrayXXd none = Eigen::ArrayXXd::Zero(4, 1);
  Histograms counts(1);
  counts.add(none);
  sums.add(Moments::of(none), counts);
  EXPECT_DOUBLE_EQ(sums.end_error(0), 2.67 / 2.0);
  EXPECT_DOUBLE_EQ(sums.largest_end_error(0), 2.67 / 2.0);
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
