// A boring mill with a quill, measured by a simulated tracer: what is identified, what is left at poses that
// no reading stood at, and what no reading can tell.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <set>
#include <string>

#include "tests/support/error_oracles.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/errors/volume/error_budget.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/sim/machine/datum.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

Machine boring_mill() {
  Machine machine;
  machine.structure = Structure::parse("w X' b Y Z W t");
  const auto add = [&](AxisName name, double low, double high, double home) {
    Axis axis;
    axis.name = name;
    axis.travel_min = low;
    axis.travel_max = high;
    axis.home = home;
    axis.reference_point = {0.1, -0.1, 0.05};
    machine.axes.push_back(axis);
  };
  add(AxisName::X, 0.0, 1.0, 0.0);
  add(AxisName::Y, 0.0, 0.8, 0.0);
  add(AxisName::Z, -0.6, 0.0, 0.0);
  add(AxisName::W, -0.4, 0.05, -0.05);
  machine.tools = {{"short", {0.0, 0.0, -0.15}, 0.0},
                   {"side", {0.12, 0.0, -0.25}, 0.0},
                   {"front", {0.0, 0.12, -0.25}, 0.0}};
  return machine;
}

/// Parabolas, which splines of one piece hold exactly, zero at home; none whose slope turns the frame, since
/// the tools, which are known, do not turn with it.
void set_quill_errors(sim::TruthMachine& truth) {
  double phase = 0.0;
  for (const Axis& axis : truth.machine().axes) {
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      const bool turns_frame =
          symbol.is_straightness() && (axis.name == AxisName::X || symbol.name() == "EZY");
      const double size = turns_frame ? 0.0 : 1e-5 * std::cos(phase += 1.0);
      const double home = axis.home, travel = axis.travel();
      truth.set_error(symbol, [=](double q) {
        const double t = (q - home) / travel;
        return size * (t + 2.0 * t * t);
      });
    }
    for (const LocationSymbol& symbol : sim::linear_locations(truth.machine(), axis.name))
      truth.set_location(symbol, (is_parallel(axis.name) ? 4e-5 : 0.0) + 2e-5 * std::sin(phase += 1.0));
  }
}

sim::Study quill_study(bool parallel_moves) {
  sim::Study study;
  study.machine = boring_mill();
  study.seed = 5;
  study.truth.perfect = true;
  study.truth.alter = set_quill_errors;
  sim::Tracking tracking;
  tracking.grid = {4, 4, 4};
  tracking.parallel_moves = parallel_moves;
  tracking.noise = {0.3e-6, 0.0, 0.0, 0.3e-6};
  study.measurements.emplace_back().settings = tracking;
  study.validation.points = 80;
  study.validation.tools = {"short", "side", "front"};
  return study;
}

ModelSpec one_piece() {
  ModelSpec model;
  model.default_function.knots = KnotChoice::IntervalCount;
  model.default_function.intervals = 1;
  return model;
}

FitOptions plain() {
  FitOptions options;
  options.threads = 1;
  options.noise = NoisePolicy::White;
  return options;
}

class ParallelAxisFit : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    simulated_ = std::make_unique<sim::SimulatedCampaign>(sim::simulate(quill_study(true)));
    result_ = std::make_unique<FitResult>(fit(simulated_->campaign, one_piece(), plain()));
  }
  static void TearDownTestSuite() {
    simulated_.reset();
    result_.reset();
  }
  static std::unique_ptr<sim::SimulatedCampaign> simulated_;
  static std::unique_ptr<FitResult> result_;
};
std::unique_ptr<sim::SimulatedCampaign> ParallelAxisFit::simulated_;
std::unique_ptr<FitResult> ParallelAxisFit::result_;

TEST_F(ParallelAxisFit, LeavesNoiseAtPosesThatNoReadingStoodAt) {
  for (const Finding& finding : result_->rank.invisible) ADD_FAILURE() << sentence(finding);
  std::printf("sigma0 %.3f, chi2/dof %.3f\n", result_->sigma0, result_->chi2 / result_->dof);
  ASSERT_EQ(result_->status, FitStatus::Ok);
  const Validation validation = validate(simulated_->validation, *result_);
  std::printf("before %.2f um, after %.3f um, coverage %.3f\n", validation.figures.rms_before * 1e6,
              validation.figures.rms_after * 1e6, validation.figures.coverage95);
  EXPECT_GT(validation.figures.rms_before, 10e-6);
  EXPECT_LT(validation.figures.rms_after, 0.5e-6);
  EXPECT_GT(validation.figures.coverage95, 0.9);
}

/// Functions of W and its two angles, against the truth in the datum of the tables.
TEST_F(ParallelAxisFit, TablesHoldTheErrorsOfTheQuill) {
  const sim::TruthInDatum truth(simulated_->truth);
  int functions = 0, angles = 0;
  for (const ErrorTableRow& row : error_table(*result_)) {
    const auto motion = row.symbol.motion();
    const auto location = row.symbol.location();
    if (motion && motion->axis == AxisName::W) {
      ++functions;
      EXPECT_NEAR(row.value, truth.value(*motion, row.position), 2.0 * row.U95 + 1e-9) << row.symbol.name();
      EXPECT_LT(row.U95, 5e-6) << row.symbol.name();
    }
    if (location && location->axis == AxisName::W) {
      ++angles;
      EXPECT_NEAR(row.value, truth.location(*location), 2.0 * row.U95) << row.symbol.name();
      EXPECT_GT(std::abs(row.value), 2.0 * row.U95) << row.symbol.name();
    }
  }
  EXPECT_GT(functions, 6 * 10);
  EXPECT_EQ(angles, 2);
}

/// What stands at home has no error of its own there: grids have W at home, the budget moves it.
TEST_F(ParallelAxisFit, GridsStandAtHomeAndTheBudgetMovesTheQuill) {
  for (const AxisPosition& position : grid_positions(result_->machine, 3))
    EXPECT_EQ(position[index_of(AxisName::W)], -0.05);
  const std::vector<VolumetricError> grid =
      testing::volumetric_grid(*result_, 3, default_conditions(*result_));
  ASSERT_EQ(grid.size(), 81U);
  for (const VolumetricError& node : grid) {
    const Tool& tool = result_->machine.tools[*result_->machine.tool_index(node.tool)];
    const VolumetricError plain = volumetric_error(*result_, node.position, tool);
    EXPECT_LT((node.value - plain.value).cwiseAbs().maxCoeff(), 1e-12 * plain.value.cwiseAbs().maxCoeff());
    EXPECT_LT((node.u.cwiseAbs2() - plain.u.cwiseAbs2()).cwiseAbs().maxCoeff(),
              1e-12 * plain.u.cwiseAbs2().maxCoeff());
  }
}

/// The same stations, Z and W moved by one share of their travels.
sim::Study quill_moved_with_z() {
  sim::Study study = quill_study(false);
  const Machine& machine = study.machine;
  const Axis &z = machine.axis(AxisName::Z), &w = machine.axis(AxisName::W);
  sim::Tracking together = std::get<sim::Tracking>(study.measurements.front().settings);
  for (const sim::SetupPlan& plan : sim::simulate(study).plans) {
    const std::string station = *plan.options.text("station");
    if (std::ranges::find(together.stations, station, &sim::Tracking::Station::name) ==
        together.stations.end())
      together.stations.push_back({station, plan.truth.station});
    together.runs.push_back({station, machine.tools[plan.tool].name, plan.points});
    for (sim::CommandedPoint& point : together.runs.back().points) {
      const double share = (point.position[index_of(AxisName::Z)] - z.travel_min) / z.travel();
      point.position[index_of(AxisName::W)] = w.travel_min + share * w.travel();
    }
  }
  study.measurements.front().settings = together;
  return study;
}

/// An error of one can be given to the other.
TEST(ParallelAxes, MovedTogetherOnlyCannotBeTold) {
  const sim::SimulatedCampaign simulated = sim::simulate(quill_moved_with_z());
  const FitResult result = fit(simulated.campaign, one_piece(), plain());
  EXPECT_EQ(result.status, FitStatus::RankDeficient);
  const auto words_of = [&](const std::string& symbol) -> std::string {
    for (const Finding& finding : result.rank.invisible) {
      if (finding.text("error") == symbol) return explanation(finding).remedy;
    }
    return "";
  };
  for (const char* symbol : {"EXW", "EZW", "EZZ", "EXZ"}) {
    EXPECT_THAT(words_of(symbol), ::testing::HasSubstr("move W while Z stands")) << symbol;
  }
  EXPECT_EQ(words_of("EXX"), "");
}

/// W at rest: its errors are zero at home and the others are identified as on a machine without it.
TEST(ParallelAxes, AQuillAtRestIsNamed) {
  const sim::SimulatedCampaign simulated = sim::simulate(quill_study(false));
  const FitResult result = fit(simulated.campaign, one_piece(), plain());
  EXPECT_EQ(result.status, FitStatus::RankDeficient);
  std::set<std::string> unseen;
  for (const Finding& finding : result.rank.invisible) unseen.insert(finding.text("error"));
  EXPECT_EQ(unseen, (std::set<std::string>{"EXW", "EYW", "EZW", "EAW", "EBW", "ECW", "EA0W", "EB0W"}));
}

}  // namespace
}  // namespace volcal
