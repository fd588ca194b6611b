// Campaigns that cannot see everything: what the rank report calls invisible is what finite differences of
// the simulator's exact transforms call invisible. Nothing of the model takes part in the second computation.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "volcal/identify/solve/fit.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/measurement/instruments.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

constexpr int kDegree = 3;
constexpr double kSigma = 0.7e-6;    // m, of every reading
constexpr double kWideError = 1e-3;  // m and rad
constexpr double kWideSquareness = 1e-3;
constexpr double kWideNuisance = 1.0;  // m
constexpr double kWeakCentre = 1e-4;   // m, default prior of a ball-bar's centre

/// Legendre polynomial of degree 1 to 3 over the travel, zero at home (the lower end).
double term(const Axis& axis, int degree, double position) {
  const auto legendre = [degree](double t) {
    if (degree == 1) return t;
    return degree == 2 ? 0.5 * (3.0 * t * t - 1.0) : 0.5 * (5.0 * t * t * t - 3.0 * t);
  };
  const auto share = [&](double q) { return 2.0 * (q - axis.travel_min) / axis.travel() - 1.0; };
  return legendre(share(position)) - legendre(share(axis.home));
}

/// One unknown: how it changes the true machine or the instruments.
struct Unknown {
  std::string name;
  double wide = 0.0;
  std::function<void(sim::TruthMachine&, double)> machine;
  std::function<void(sim::SetupPlan&, double)> setup = nullptr;
  std::size_t setup_index = 0;
};

std::vector<Unknown> machine_unknowns(const Machine& machine) {
  std::vector<Unknown> unknowns;
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      const bool positioning = !is_rotation(component) && index_of(component) == index_of(axis.name);
      // a straightness has no least-squares slope, and Legendre's second and third degree have none
      for (int n = is_rotation(component) || positioning ? 1 : 2; n <= kDegree; ++n) {
        unknowns.push_back({symbol.name(), kWideError, [=](sim::TruthMachine& truth, double step) {
                              truth.set_error(symbol, [=](double q) { return step * term(axis, n, q); });
                            }});
      }
    }
  }
  for (const LocationSymbol symbol : machine.datum.squareness()) {
    unknowns.push_back({symbol.name(), kWideSquareness,
                        [=](sim::TruthMachine& truth, double step) { truth.set_location(symbol, step); }});
  }
  return unknowns;
}

void add_point(std::vector<Unknown>& unknowns, std::size_t setup, double wide,
               Eigen::Vector3d sim::InstrumentTruth::*point) {
  for (int k = 0; k < 3; ++k) {
    unknowns.push_back({"nuisance", wide, nullptr,
                        [=](sim::SetupPlan& plan, double step) { (plan.truth.*point)[k] += step; }, setup});
  }
}

std::vector<Unknown> all_unknowns(const sim::SimulatedCampaign& simulated) {
  std::vector<Unknown> unknowns = machine_unknowns(simulated.campaign.machine);
  const auto add_scalar = [&](std::size_t setup, double sim::InstrumentTruth::*scalar) {
    unknowns.push_back({"nuisance", kWideNuisance, nullptr,
                        [=](sim::SetupPlan& plan, double step) { plan.truth.*scalar += step; }, setup});
  };
  for (std::size_t i = 0; i < simulated.plans.size(); ++i) {
    const std::string& instrument = simulated.plans[i].instrument;
    if (instrument == "ball-bar") {
      add_point(unknowns, i, kWeakCentre, &sim::InstrumentTruth::centre);
      add_scalar(i, &sim::InstrumentTruth::length_error);
    } else if (instrument == "laser-tracer") {
      add_point(unknowns, i, kWideNuisance, &sim::InstrumentTruth::station);
      add_scalar(i, &sim::InstrumentTruth::dead_path);
    } else {
      add_scalar(i, &sim::InstrumentTruth::offset);
    }
  }
  return unknowns;
}

/// Readings without noise.
Eigen::VectorXd exact_readings(const std::vector<sim::SetupPlan>& plans, const sim::TruthMachine& truth) {
  std::vector<Eigen::Vector3d> tools;
  for (const Tool& tool : truth.machine().tools) tools.push_back(tool.offset);
  std::vector<double> values;
  for (const sim::SetupPlan& plan : plans) {
    const sim::MeasuringConditions conditions{truth, {}, tools, 1, true};
    const volcal::Setup setup = sim::measure(plan, conditions, 0.0);
    values.insert(values.end(), setup.readings.value[0].begin(), setup.readings.value[0].end());
  }
  return Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

struct Sight {
  double gain = 0.0;                       ///< standard uncertainty before over after the readings
  double null_share = 0.0;                 ///< of the error in directions that no reading sees
  std::map<std::string, double> coupling;  ///< 0..1, with another error in these directions
};

/// By name of error: how much the readings say of it when everything else is unknown as well.
std::map<std::string, Sight> sight_by_finite_differences(const sim::SimulatedCampaign& simulated) {
  std::vector<sim::SetupPlan> plans = simulated.plans;
  for (sim::SetupPlan& plan : plans) plan.noise = {};
  const sim::TruthMachine perfect(simulated.campaign.machine);
  const auto unknowns = all_unknowns(simulated);
  const Eigen::VectorXd nominal = exact_readings(plans, perfect);
  const auto n = static_cast<Eigen::Index>(unknowns.size());
  Eigen::MatrixXd jacobian(nominal.size(), n);  // per prior standard deviation, in standard deviations
  constexpr double kSlopeStep = 1e-6;
  for (Eigen::Index j = 0; j < n; ++j) {
    const Unknown& unknown = unknowns[static_cast<std::size_t>(j)];
    const auto readings = [&](double step) {
      sim::TruthMachine truth = perfect;
      std::vector<sim::SetupPlan> moved = plans;
      if (unknown.machine) unknown.machine(truth, step);
      if (unknown.setup) unknown.setup(moved[unknown.setup_index], step);
      return exact_readings(moved, truth);
    };
    jacobian.col(j) =
        (readings(kSlopeStep) - readings(-kSlopeStep)) * (unknown.wide / (2.0 * kSlopeStep * kSigma));
  }
  const Eigen::MatrixXd information = jacobian.transpose() * jacobian;
  const Eigen::MatrixXd posterior =
      (information + Eigen::MatrixXd::Identity(n, n)).llt().solve(Eigen::MatrixXd::Identity(n, n));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  const auto unseen = (eigen.eigenvalues().array() < 1.0).count();
  const Eigen::MatrixXd null_space = eigen.eigenvectors().leftCols(unseen);
  std::map<std::string, std::vector<Eigen::Index>> terms;
  for (Eigen::Index j = 0; j < n; ++j) terms[unknowns[static_cast<std::size_t>(j)].name].push_back(j);
  const Eigen::MatrixXd projector = null_space * null_space.transpose();
  std::map<std::string, Sight> sight;
  for (const auto& [name, mine] : terms) {
    const auto count = static_cast<double>(mine.size());
    sight[name].gain = std::sqrt(count / posterior(mine, mine).trace());
    sight[name].null_share = projector(mine, mine).trace() / count;
    for (const auto& [other, others] : terms) {
      sight[name].coupling[other] =
          projector(mine, others).norm() /
          std::sqrt(projector(mine, mine).norm() * projector(others, others).norm() + 1e-30);
    }
  }
  return sight;
}

FitResult fit_polynomials(const Campaign& campaign) {
  ModelSpec model;
  model.default_function.basis = "legendre";
  model.default_function.degree = kDegree;
  return fit(campaign, model);
}

std::string table(const FitResult& result, const std::map<std::string, Sight>& sight) {
  std::string text = fmt::format("{:6s} {:>8s} {:>9s} {:>11s}  reason; remedy\n", "error", "report",
                                 "f.d. gain", "null share");
  for (const Observability& error : result.rank.errors) {
    const Sight& mine = sight.at(error.symbol.name());
    text += fmt::format("{:6s} {:>8s} {:9.1f} {:11.4f}  {}; {}\n", error.symbol.name(),
                        error.visible ? "visible" : "-", mine.gain, mine.null_share,
                        explanation(error.cause).reason, explanation(error.cause).remedy);
  }
  return text;
}

sim::Study ball_bar_and_diagonals(std::size_t machine) {
  sim::Study study;
  study.machine = sim::reference_machines()[machine];
  study.seed = 3;
  sim::BallBarCircles circles;
  circles.points_per_turn = 72;
  study.measurements.emplace_back().settings = circles;
  study.measurements.emplace_back().settings = sim::Diagonals{};
  return study;
}

sim::Study one_tracer_setup(std::size_t machine) {
  sim::Study study;
  study.machine = sim::reference_machines()[machine];
  study.seed = 3;
  sim::Tracking tracking;
  tracking.grid = {6, 5, 5};
  tracking.stations = {{"P1", {-0.3, -0.2, -0.2}}};
  tracking.runs = {{"P1", "short"}};
  study.measurements.emplace_back().settings = tracking;
  return study;
}

struct Partial {
  std::string name;
  sim::Study (*study)(std::size_t machine);
  std::size_t machine;
};

void PrintTo(const Partial& partial, std::ostream* out) { *out << partial.name << partial.machine; }

bool names_nuisance(const std::string& reason) {
  return std::ranges::any_of(std::vector<std::string>{"station", "centre", "offset", "bar length"},
                             [&](const std::string& word) { return reason.find(word) != std::string::npos; });
}

class PartialCampaign : public ::testing::TestWithParam<Partial> {};

// The report calls an error visible when the readings improve a very wide prior tenfold; within a sixth of
// that the two computations may differ, since theirs are not the same priors.
constexpr double kLeastGain = 8.0;
constexpr double kSafeGain = 14.0;
constexpr double kNothing = 1e-4;

TEST_P(PartialCampaign, IsToldApartAsFiniteDifferencesTellIt) {
  const auto simulated = sim::simulate(GetParam().study(GetParam().machine));
  const FitResult result = fit_polynomials(simulated.campaign);
  const auto sight = sight_by_finite_differences(simulated);
  SCOPED_TRACE(table(result, sight));
  EXPECT_EQ(result.status, FitStatus::RankDeficient);
  ASSERT_EQ(result.rank.errors.size(), 21U);
  std::size_t visible = 0;
  for (const Observability& error : result.rank.errors) {
    const Sight& mine = sight.at(error.symbol.name());
    if (mine.gain > kSafeGain) {
      EXPECT_TRUE(error.visible) << error.symbol.name();
    }
    if (mine.gain < kLeastGain) {
      EXPECT_FALSE(error.visible) << error.symbol.name();
    }
    if (mine.null_share < kNothing) {
      EXPECT_TRUE(error.visible) << error.symbol.name();
    }
    if (!error.visible) {
      EXPECT_GT(mine.null_share, 20 * kNothing) << error.symbol.name();
    }
    visible += error.visible ? 1 : 0;
  }
  EXPECT_EQ(result.rank.invisible.size(), 21U - visible);
  EXPECT_GE(visible, 2U);
}

TEST_P(PartialCampaign, SaysWhyInWordsThatHold) {
  const auto simulated = sim::simulate(GetParam().study(GetParam().machine));
  const FitResult result = fit_polynomials(simulated.campaign);
  const auto sight = sight_by_finite_differences(simulated);
  SCOPED_TRACE(table(result, sight));
  for (const Observability& error : result.rank.errors) {
    if (error.visible) {
      EXPECT_FALSE(error.cause) << error.symbol.name();
      continue;
    }
    const Explanation words = explanation(error.cause);
    EXPECT_NE(words.remedy, "") << error.symbol.name();
    const Sight& mine = sight.at(error.symbol.name());
    const bool no_lever = words.reason.find("every tool offset lies on") != std::string::npos;
    EXPECT_EQ(no_lever, mine.null_share > 0.9999) << error.symbol.name();
    if (no_lever) {
      EXPECT_THAT(words.remedy, HasSubstr("tool offset sideways to Z"));
      continue;
    }
    EXPECT_THAT(words.reason, HasSubstr("can be exchanged with")) << error.symbol.name();
    double strongest = 0.0;
    for (const auto& [other, coupling] : mine.coupling) {
      const bool named = other == "nuisance"
                             ? names_nuisance(words.reason)
                             : other != error.symbol.name() && words.reason.find(other) != std::string::npos;
      if (named) strongest = std::max(strongest, coupling);
    }
    EXPECT_GT(strongest, 0.05) << error.symbol.name()
                               << ": no partner named here takes part in what no reading sees";
  }
}

TEST_P(PartialCampaign, StillGivesWhatIsDetermined) {
  const auto simulated = sim::simulate(GetParam().study(GetParam().machine));
  const FitResult result = fit_polynomials(simulated.campaign);
  const auto sight = sight_by_finite_differences(simulated);
  EXPECT_TRUE(result.parameters.allFinite());
  EXPECT_TRUE(result.covariance.allFinite());
  for (const Observability& error : result.rank.errors) {
    if (!error.visible) {
      EXPECT_GT(error.u_rms, 20e-6) << error.symbol.name();
    }
    if (sight.at(error.symbol.name()).null_share < kNothing) {
      EXPECT_LT(error.u_rms, 0.3 * kWideError) << error.symbol.name();
    }
  }
}

std::vector<Partial> partial_campaigns() {
  std::vector<Partial> all;
  for (std::size_t machine = 0; machine < 4; ++machine) {
    all.push_back({"BallBarAndDiagonals", ball_bar_and_diagonals, machine});
    all.push_back({"OneTracerSetup", one_tracer_setup, machine});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, PartialCampaign, ::testing::ValuesIn(partial_campaigns()),
                         [](const auto& tested) {
                           return tested.param.name + std::to_string(tested.param.machine);
                         });

// The remedies that the report names are remedies: the same circles and diagonals with two sideways tools as
// well, or tracer lengths from four stations with three tools, leave no direction unseen (of cubic
// polynomials).
TEST(PartialCampaign, RemediesOfTheReportLeaveNothingUnseen) {
  const sim::Study study = ball_bar_and_diagonals(1);
  sim::SimulatedCampaign simulated = sim::simulate(study);
  for (const char* tool : {"side_x", "side_y"}) {
    sim::Study with_tool = study;
    std::get<sim::BallBarCircles>(with_tool.measurements[0].settings).tool = tool;
    std::get<sim::Diagonals>(with_tool.measurements[1].settings).tool = tool;
    const auto more = sim::simulate(with_tool).plans;
    simulated.plans.insert(simulated.plans.end(), more.begin(), more.end());
  }
  const auto circles_and_diagonals = sight_by_finite_differences(simulated);
  sim::Study tracer;
  tracer.machine = study.machine;
  sim::Tracking tracking;
  tracking.grid = {6, 5, 5};
  tracer.measurements.emplace_back().settings = tracking;
  const auto lengths = sight_by_finite_differences(sim::simulate(tracer));
  for (const auto& sight : {circles_and_diagonals, lengths}) {
    for (const auto& [name, mine] : sight) {
      if (name == "nuisance") continue;
      EXPECT_LT(mine.null_share, kNothing) << name;
      EXPECT_GT(mine.gain, kLeastGain) << name;
    }
  }
}

// A squareness and the straightness of its axis displace along the same direction: two positions of Y do not
// tell them apart, whatever the stations and tools; five do.
TEST(PartialCampaign, ASquarenessAtTwoPositionsAsksForPositions) {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.seed = 3;
  sim::Tracking tracking;
  tracking.jitter = 0.0;
  const auto squareness = [&](int positions) {
    tracking.grid = {6, positions, 5};
    study.measurements.clear();
    study.measurements.emplace_back().settings = tracking;
    const FitResult result = fit_polynomials(sim::simulate(study).campaign);
    return *std::ranges::find(result.rank.errors, MachineError::parse("EC0Y"), &Observability::symbol);
  };
  const Observability at_two = squareness(2);
  EXPECT_FALSE(at_two.visible);
  EXPECT_EQ(
      explanation(at_two.cause).reason,
      "the readings stand at too few positions of axis Y, or on too little of its travel, to tell it from "
      "EXY");
  EXPECT_EQ(explanation(at_two.cause).remedy, "add positions along the whole travel of axis Y");
  EXPECT_TRUE(squareness(5).visible);
}

// With home between two positions a straightness may rise at both and the station with it: neither another
// station nor another tool tells, but a third position.
TEST(PartialCampaign, AStraightnessAtTwoPositionsAsksForPositions) {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  Axis& y = *std::ranges::find(study.machine.axes, AxisName::Y, &Axis::name);
  y.home = 0.5 * (y.travel_min + y.travel_max);
  study.seed = 3;
  sim::Tracking tracking;
  tracking.jitter = 0.0;
  const auto straightness = [&](int positions) {
    tracking.grid = {6, positions, 5};
    study.measurements.clear();
    study.measurements.emplace_back().settings = tracking;
    const FitResult result = fit_polynomials(sim::simulate(study).campaign);
    return *std::ranges::find(result.rank.errors, MachineError::parse("EXY"), &Observability::symbol);
  };
  const Observability at_two = straightness(2);
  EXPECT_FALSE(at_two.visible);
  EXPECT_EQ(explanation(at_two.cause).remedy, "add positions along axis Y");
  EXPECT_TRUE(straightness(5).visible);
}

// Y stands beside its home, so that its errors are constant and like the offset of the line.
TEST(PartialCampaign, AnAxisThatStandsStillHidesItsErrorsAndItsSquareness) {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.seed = 3;
  sim::AxisLines lines;
  lines.axes = {AxisName::X};
  study.measurements.emplace_back().settings = lines;
  const FitResult result = fit_polynomials(sim::simulate(study).campaign);
  for (const char* name : {"EXY", "EC0Y"}) {
    const auto error =
        std::ranges::find(result.rank.errors, MachineError::parse(name), &Observability::symbol);
    EXPECT_FALSE(error->visible) << name;
    EXPECT_EQ(explanation(error->cause).reason, "axis Y does not move in this campaign") << name;
    EXPECT_EQ(explanation(error->cause).remedy, "measure along axis Y") << name;
  }
}

}  // namespace
}  // namespace volcal
