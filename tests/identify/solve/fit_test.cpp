// Identification against simulated truth. The simulator shares no physics with the model.

#include "volcal/identify/solve/fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

sim::Study small_study(std::size_t machine, const sim::Tracking& tracking) {
  sim::Study study;
  study.machine = sim::reference_machines()[machine];
  study.seed = 11 + machine;
  study.measurements.emplace_back().settings = tracking;
  study.validation.points = 60;
  return study;
}

sim::Tracking small_tracking() {
  sim::Tracking tracking;
  tracking.grid = {6, 5, 5};
  return tracking;
}

ModelSpec fitted_splines(int intervals) {
  ModelSpec model;
  model.default_function.knots = KnotChoice::IntervalCount;
  model.default_function.intervals = intervals;
  return model;
}

const Observability& figure_of(const FitResult& result, const std::string& symbol) {
  const auto found =
      std::ranges::find(result.rank.errors, MachineError::parse(symbol), &Observability::symbol);
  if (found == result.rank.errors.end()) throw std::out_of_range(symbol);
  return *found;
}

class FitOnStructure : public ::testing::TestWithParam<std::size_t> {};

TEST_P(FitOnStructure, FallsFromMachineErrorToNoise) {
  const auto simulated = sim::simulate(small_study(GetParam(), small_tracking()));
  const FitResult result = fit(simulated.campaign, ModelSpec{});
  EXPECT_EQ(result.status, FitStatus::Ok);
  const Validation validation = validate(simulated.validation, result);
  EXPECT_GT(validation.figures.rms_before, 10e-6);
  EXPECT_LT(validation.figures.rms_after, 1.2e-6);
  EXPECT_GT(validation.figures.coverage95, 0.85);
  EXPECT_NEAR(result.sigma0, 1.0, 0.15);
}

INSTANTIATE_TEST_SUITE_P(Structures, FitOnStructure, ::testing::Values(0U, 1U, 2U, 3U));

TEST(Fit, CompressedAndPerReadingProblemsAgree) {
  sim::Tracking tracking;
  tracking.grid = {4, 4, 4};
  const auto simulated = sim::simulate(small_study(0, tracking));
  FitOptions options;
  options.variance_components = false;
  const FitResult compressed = fit(simulated.campaign, fitted_splines(3), options);
  options.solver = SolverKind::PerReading;
  const FitResult reference = fit(simulated.campaign, fitted_splines(3), options);
  ASSERT_NE(reference.status, FitStatus::NotConverged);
  ASSERT_NE(compressed.status, FitStatus::NotConverged);
  // A length of 1.5 m is rounded to 2e-16 m, 3e-10 of its sigma; over 1,024 readings the cost knows no better
  // than some 1e-11.
  EXPECT_NEAR(compressed.final_cost / reference.final_cost, 1.0, 3e-11);
  const double scale = reference.parameters.cwiseAbs().maxCoeff();
  EXPECT_LT((compressed.parameters - reference.parameters).cwiseAbs().maxCoeff(), 1e-9 * scale);
}

TEST(Fit, DoesNotDependOnTheNumberOfThreads) {
  const auto simulated = sim::simulate(small_study(1, small_tracking()));
  FitOptions options;
  options.threads = 1;
  const FitResult one = fit(simulated.campaign, fitted_splines(4), options);
  options.threads = 3;
  const FitResult three = fit(simulated.campaign, fitted_splines(4), options);
  EXPECT_TRUE(one.parameters == three.parameters);
  EXPECT_TRUE(one.covariance == three.covariance);
}

/// Its functions state breakpoints and values; what they were chosen and smoothed by is chosen anew.
TEST(Fit, OfAnIdentifiedModelIsTheFitThatItCameFrom) {
  const auto simulated = sim::simulate(small_study(0, small_tracking()));
  const FitResult first = fit(simulated.campaign, ModelSpec{}),
                  again = fit(simulated.campaign, first.identified);
  ASSERT_EQ(again.functions.size(), first.functions.size());
  for (std::size_t i = 0; i < first.functions.size(); ++i) {
    EXPECT_EQ(again.functions[i].intervals, first.functions[i].intervals) << first.functions[i].symbol.name();
    EXPECT_TRUE(again.functions[i].smoothed);
    EXPECT_NEAR(again.functions[i].effective_parameters, first.functions[i].effective_parameters, 1e-6);
  }
  EXPECT_NEAR(again.chi2, first.chi2, 1e-6 * first.chi2);
  EXPECT_TRUE(again.parameters.isApprox(first.parameters, 1e-6));
}

class FitOfTracking : public ::testing::TestWithParam<const char*> {};

TEST_P(FitOfTracking, ConvergesFromStationsGuessedFiveCentimetresOff) {
  sim::Tracking tracking = small_tracking();
  tracking.instrument = GetParam();
  const auto simulated = sim::simulate(small_study(0, tracking));
  FitOptions options;
  options.noise = NoisePolicy::White;
  const FitResult good = fit(simulated.campaign, fitted_splines(4), options);
  Campaign moved = simulated.campaign;
  int sign = 1;
  for (volcal::Setup& setup : moved.setups) {
    const Eigen::Vector3d station = *setup.options.vector("station");
    setup.options.set("station", Eigen::Vector3d(station + Eigen::Vector3d(0.05 * sign, -0.05, 0.05)));
    sign = -sign;
  }
  const FitResult far = fit(moved, fitted_splines(4), options);
  EXPECT_EQ(far.status, good.status);
  // Not equal to rounding: the length-proportional part of the noise is taken from the guess.
  const Eigen::ArrayXd u = good.covariance.diagonal().cwiseSqrt().array() + 1e-12;
  EXPECT_LT(((far.parameters - good.parameters).array().abs() / u).maxCoeff(), 0.1);
}

/// The machine's repeatability as an angle depends on the distance, of which a judgement knows a guess too.
TEST_P(FitOfTracking, IsJudgedAlikeFromStationsGuessedFiveCentimetresOff) {
  sim::Tracking tracking = small_tracking();
  tracking.instrument = GetParam();
  auto simulated = sim::simulate(small_study(0, tracking));
  FitOptions options;
  options.noise = NoisePolicy::White;
  const FitResult result = fit(simulated.campaign, fitted_splines(4), options);
  const double good = validate(simulated.campaign, result).figures.reduced_chi2;
  for (volcal::Setup& setup : simulated.campaign.setups) {
    const Eigen::Vector3d station = *setup.options.vector("station");
    setup.options.set("station", Eigen::Vector3d(station + Eigen::Vector3d::Constant(0.05)));
  }
  EXPECT_NEAR(validate(simulated.campaign, result).figures.reduced_chi2 / good, 1.0, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Instruments, FitOfTracking, ::testing::Values("laser-tracer", "laser-tracker"));

TEST(Validate, RestsOnNothingThatIsLeftOut) {
  auto simulated = sim::simulate(small_study(0, small_tracking()));
  const FitResult result = fit(simulated.campaign, fitted_splines(4));
  volcal::Setup& points = simulated.validation.setups.front();
  const double other_components = validate(simulated.validation, result).figures.rms_after;
  points.left_out = {{3, 1, "one component"}, {5, 0, "all"}, {5, 1, "all"}, {5, 2, "all"}};
  const ValidationFigures sound = validate(simulated.validation, result).figures;
  EXPECT_EQ(sound.lengths, points.readings.size() - 1);
  EXPECT_NE(sound.rms_after, other_components);
  for (const LeftOutReading& reading : points.left_out) {
    points.readings.value[reading.channel][reading.row] += 1e-4;
  }
  const ValidationFigures spoilt = validate(simulated.validation, result).figures;
  EXPECT_NEAR(spoilt.rms_before / sound.rms_before, 1.0, 1e-9);
  EXPECT_NEAR(spoilt.rms_after / sound.rms_after, 1.0, 1e-9);
  EXPECT_NEAR(spoilt.max_after / sound.max_after, 1.0, 1e-9);
  EXPECT_NEAR(spoilt.reduced_chi2 / sound.reduced_chi2, 1.0, 1e-9);
  EXPECT_EQ(spoilt.coverage95, sound.coverage95);
}

/// Positions 0, 0.1 ... 1 of X; the last row is left out whole, the first in one of two channels.
TEST(Resolution, ComesFromReadingsThatAreNotLeftOut) {
  Campaign campaign;
  campaign.machine = sim::reference_machines()[0];
  volcal::Setup& setup = campaign.setups.emplace_back();
  setup.readings.value.assign(2, std::vector<double>(11, 0.0));
  for (int i = 0; i <= 10; ++i) {
    setup.readings.position[0].push_back(0.1 * i);
    setup.readings.source_line.push_back(i + 2);
  }
  EXPECT_EQ(measured_range(campaign, AxisName::X).max, 1.0);
  EXPECT_EQ(automatic_intervals(campaign, AxisName::X), 10);
  setup.left_out = {{0, 1, "half"}, {10, 0, "whole"}, {10, 1, "whole"}};
  EXPECT_EQ(measured_range(campaign, AxisName::X).min, 0.0);
  EXPECT_EQ(measured_range(campaign, AxisName::X).max, 0.9);
  EXPECT_EQ(automatic_intervals(campaign, AxisName::X), 9);
}

TEST(Fit, EstimatesAWrongStatedSigma) {
  auto simulated = sim::simulate(small_study(0, small_tracking()));
  for (volcal::Setup& setup : simulated.campaign.setups) {
    setup.repeatability *= 0.5;
    for (const char* key : {"constant", "per_metre"}) setup.noise.set(key, 0.5 * *setup.noise.number(key));
  }
  const FitResult result = fit(simulated.campaign, fitted_splines(5));
  ASSERT_EQ(result.variance_components.size(), 1U);
  EXPECT_NEAR(result.variance_components[0].scale, 2.0, 0.15);
  EXPECT_EQ(result.status, FitStatus::LackOfFit);
  const Finding& first = result.findings.front();
  EXPECT_EQ(first.code, FindingCode::NoiseSigmaContradicted);
  EXPECT_EQ(first.text("instrument"), "laser-tracer");
  EXPECT_NEAR(first.number("times").si, 2.0, 0.15);
  EXPECT_FALSE(first.flag("unit_slip"));
}

/// A tracker whose lengths are as good as stated and whose angles are twice as bad.
TEST(Fit, EstimatesTheNoiseOfLengthsAndAnglesApart) {
  sim::Tracking tracking = small_tracking();
  tracking.instrument = "laser-tracker";
  tracking.noise.angle = 5e-6;
  auto simulated = sim::simulate(small_study(0, tracking));
  for (volcal::Setup& setup : simulated.campaign.setups) {
    setup.noise.set("angle", 0.5 * *setup.noise.number("angle"));
  }
  const FitResult result = fit(simulated.campaign, fitted_splines(5));
  ASSERT_EQ(result.variance_components.size(), 2U);
  EXPECT_EQ(result.variance_components[0].instrument, "laser-tracker");
  EXPECT_NEAR(result.variance_components[0].scale, 1.0, 0.1);
  EXPECT_EQ(result.variance_components[1].instrument, "laser-tracker angles");
  EXPECT_NEAR(result.variance_components[1].scale, 2.0, 0.1);
  EXPECT_EQ(result.variance_components[1].observations, 2 * result.variance_components[0].observations);
}

TEST(Fit, SuspectsTheUnitOfANoiseAThousandTimesTooSmall) {
  auto simulated = sim::simulate(small_study(0, small_tracking()));
  for (volcal::Setup& setup : simulated.campaign.setups) {
    setup.repeatability *= 1e-3;
    for (const char* key : {"constant", "per_metre"}) setup.noise.set(key, 1e-3 * *setup.noise.number(key));
  }
  const FitResult result = fit(simulated.campaign, fitted_splines(5));
  EXPECT_EQ(result.findings.front().code, FindingCode::NoiseSigmaContradicted);
  EXPECT_TRUE(result.findings.front().flag("unit_slip"));
}

TEST(Fit, AsksWhetherReadingsThatHardlyScatterAreInAnotherUnit) {
  auto simulated = sim::simulate(small_study(0, small_tracking()));
  for (volcal::Setup& setup : simulated.campaign.setups) {
    setup.repeatability *= 1e3;
    for (const char* key : {"constant", "per_metre"}) setup.noise.set(key, 1e3 * *setup.noise.number(key));
  }
  const FitResult result = fit(simulated.campaign, fitted_splines(5));
  EXPECT_EQ(result.findings.front().code, FindingCode::NoiseSigmaContradicted);
  EXPECT_TRUE(result.findings.front().flag("too_quiet"));
  EXPECT_FALSE(result.findings.front().flag("unit_slip"));
}

TEST(Fit, ListsAnOutlierAndRemovesItOnlyWhenAsked) {
  auto simulated = sim::simulate(small_study(0, small_tracking()));
  simulated.campaign.setups[2].readings.value[0][40] += 20e-6;
  const auto record_of = [](const FitResult& result) {
    return *std::ranges::find_if(result.residuals,
                                 [](const ResidualRecord& r) { return r.setup == 2 && r.row == 40; });
  };
  const FitResult listed = fit(simulated.campaign, fitted_splines(5));
  EXPECT_TRUE(record_of(listed).flagged);
  EXPECT_FALSE(record_of(listed).removed);
  FitOptions options;
  options.outliers = OutlierPolicy::Remove;
  const FitResult removed = fit(simulated.campaign, fitted_splines(5), options);
  EXPECT_TRUE(record_of(removed).removed);
  EXPECT_NEAR(record_of(removed).residual(), 20e-6, 4e-6);
}

/// More of one setup than rounds of one each would remove; a quarter of a setup is the most.
TEST(Fit, RemovesManyOutliersOfOneSetup) {
  auto simulated = sim::simulate(small_study(0, small_tracking()));
  auto& value = simulated.campaign.setups[2].readings.value[0];
  for (std::size_t row = 3; row < 3 + 22 * 6; row += 6) value[row] += row % 4 == 1 ? 60e-6 : -45e-6;
  FitOptions options;
  options.outliers = OutlierPolicy::Remove;
  const FitResult result = fit(simulated.campaign, fitted_splines(5), options);
  for (const ResidualRecord& record : result.residuals) {
    const bool wrong = record.setup == 2 && record.row >= 3 && record.row < 3 + 22 * 6 && record.row % 6 == 3;
    EXPECT_TRUE(!wrong || record.removed) << "row " << record.row;
  }
  EXPECT_LE(std::ranges::count_if(result.residuals, &ResidualRecord::removed), 24);
  EXPECT_NEAR(result.sigma0, 1.0, 0.1);
}

/// The centre of a ball-bar circle is believed to 0.1 mm unless the campaign says otherwise.
TEST(Fit, SaysThatAGuessIsContradicted) {
  auto study = small_study(0, small_tracking());
  study.measurements.emplace_back().settings = sim::BallBarCircles{};
  auto simulated = sim::simulate(study);
  const auto bar = std::ranges::find(simulated.campaign.setups, "ball-bar", &Setup::instrument);
  ASSERT_NE(bar, simulated.campaign.setups.end());
  const auto told = [&] {
    const FitResult result = fit(simulated.campaign, fitted_splines(4));
    return std::ranges::count_if(result.findings, [&](const Finding& finding) {
      return finding.code == FindingCode::PriorContradicted &&
             finding.text("block") == bar->name + ": centre" && finding.text("parameter") == "x" &&
             std::abs(finding.number("miss").si - 30e-3) < 0.5e-3 && finding.number("sigma").unit == "mm" &&
             std::abs(finding.number("sigma").in_unit() - 0.1) < 1e-9 && finding.flag("default");
    });
  };
  EXPECT_EQ(told(), 0);
  Eigen::Vector3d centre = *bar->options.vector("centre");
  centre.x() += 30e-3;
  bar->options.set("centre", centre);
  EXPECT_EQ(told(), 1);
}

/// What no reading sees has the uncertainty of the wide prior, whatever the choice of knots.
TEST(Fit, AnInvisibleFunctionIsNotMadeKnownBySmoothing) {
  auto study = small_study(0, small_tracking());
  auto& tracking = std::get<sim::Tracking>(study.measurements[0].settings);
  tracking.runs.clear();
  for (const char* station : {"P1", "P2", "P3", "P4"}) tracking.runs.push_back({station, "short"});
  const FitResult result = fit(sim::simulate(study).campaign, ModelSpec{});
  ASSERT_FALSE(figure_of(result, "ECZ").visible);
  ASSERT_TRUE(figure_of(result, "EXX").visible);
  for (const FunctionSummary& function : result.functions)
    EXPECT_EQ(std::isnan(function.effective_parameters), !figure_of(result, function.symbol.name()).visible);
  EXPECT_TRUE(std::isnan(figure_of(result, "ECZ").effective_parameters));
  for (const ErrorTableRow& row : error_table(result)) {
    if (row.symbol.name() == "ECZ" && std::abs(row.position - result.machine.axis(AxisName::Z).home) > 0.1) {
      EXPECT_GT(row.u, 50e-6) << row.position;
    }
    if (row.symbol.name() == "EXX") {
      EXPECT_LT(row.u, 2e-6) << row.position;
    }
  }
}

TEST(Fit, RollOfTheLastAxisNeedsASidewaysTool) {
  auto study = small_study(0, small_tracking());
  auto& tracking = std::get<sim::Tracking>(study.measurements[0].settings);
  tracking.runs.clear();
  for (const char* station : {"P1", "P2", "P3", "P4"}) tracking.runs.push_back({station, "short"});
  tracking.stations = {{"P1", {-0.3, -0.2, -0.2}},
                       {"P2", {1.3, -0.2, -0.3}},
                       {"P3", {1.2, 0.8, -0.2}},
                       {"P4", {-0.2, 0.8, -0.3}}};
  const FitResult result = fit(sim::simulate(study).campaign, fitted_splines(4));
  EXPECT_EQ(result.status, FitStatus::RankDeficient);
  const Observability& roll = figure_of(result, "ECZ");
  EXPECT_FALSE(roll.visible);
  const Finding cause{FindingCode::NotVisibleToolsOnOneAxis, {{"error", "ECZ"}, {"about", "Z"}}};
  EXPECT_EQ(roll.cause, cause);
  EXPECT_THAT(result.rank.invisible, ::testing::Contains(cause));
  EXPECT_THAT(result.findings, ::testing::Contains(cause));
  EXPECT_TRUE(figure_of(result, "EXX").visible);
  EXPECT_TRUE(result.covariance.allFinite());
}

TEST(Fit, ASingleStationIsNamedAsTheReason) {
  auto study = small_study(0, small_tracking());
  auto& tracking = std::get<sim::Tracking>(study.measurements[0].settings);
  tracking.stations = {{"P1", {-0.3, -0.2, -0.2}}};
  tracking.runs = {{"P1", "short"}};
  const FitResult result = fit(sim::simulate(study).campaign, fitted_splines(4));
  EXPECT_EQ(result.status, FitStatus::RankDeficient);
  const auto invisible =
      std::ranges::count_if(result.rank.errors, [](const Observability& e) { return !e.visible; });
  EXPECT_GE(invisible, 6);
  EXPECT_TRUE(std::ranges::any_of(result.rank.errors, [](const Observability& e) {
    return e.cause && e.cause->code == FindingCode::NotVisibleExchangeable &&
           std::ranges::count(e.cause->texts("remedies"), "stations") == 1;
  }));
}

TEST(Fit, TwelveErrorModelLeavesTheAngularErrorsOut) {
  ModelSpec model = fitted_splines(4);
  for (const AxisName axis : {AxisName::X, AxisName::Y, AxisName::Z}) {
    for (const Component component : {Component::A, Component::B, Component::C}) {
      model.functions[{component, axis}].basis = "zero";
    }
  }
  const auto simulated = sim::simulate(small_study(0, small_tracking()));
  const FitResult result = fit(simulated.campaign, model);
  EXPECT_EQ(result.layout.symbols().size(), 9U);
  EXPECT_EQ(result.status, FitStatus::LackOfFit) << "the simulated machine has angular errors";
}

/// Noise in proportion to length counts from where the station is found to stand.
TEST(Fit, AStationsGuessChangesNoStatus) {
  auto simulated = sim::simulate(small_study(0, small_tracking()));
  const FitResult near = fit(simulated.campaign, fitted_splines(4));
  const auto tells_guess = [](const FitResult& result) {
    return std::ranges::count(result.findings, FindingCode::StationFarFromGuess, &Finding::code) > 0;
  };
  EXPECT_FALSE(tells_guess(near));
  for (volcal::Setup& setup : simulated.campaign.setups) {
    setup.options.set("station",
                      Eigen::Vector3d(*setup.options.vector("station") + Eigen::Vector3d(0.4, -0.3, 0.2)));
  }
  const FitResult far = fit(simulated.campaign, fitted_splines(4));
  EXPECT_EQ(far.status, near.status);
  EXPECT_NEAR(far.sigma0, near.sigma0, 0.01 * near.sigma0);
  EXPECT_TRUE(tells_guess(far));
}

}  // namespace
}  // namespace volcal
