#include "volcal/identify/solve/normals/sample_start.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "volcal/identify/solve/normals/stated_sigma.h"
#include "volcal/model/functions/registry.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

constexpr std::size_t kAlways = 1, kNever = std::numeric_limits<std::size_t>::max();

Campaign campaign_with_moved_stations() {
  sim::Tracking tracking;
  tracking.grid = {14, 8, 8};
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.seed = 31;
  study.measurements.emplace_back().settings = tracking;
  Campaign campaign = sim::simulate(study).campaign;
  for (volcal::Setup& setup : campaign.setups) {
    const Eigen::Vector3d station = *setup.options.vector("station");
    setup.options.set("station", Eigen::Vector3d(station + Eigen::Vector3d(2e-3, -2e-3, 2e-3)));
  }
  return campaign;
}

ModelSpec splines_of_tracking(const Machine& machine) {
  ModelSpec model;
  for (const Axis& axis : machine.axes) {
    FunctionSpec function;
    function.knots = KnotChoice::Explicit;
    function.breakpoints = uniform_breakpoints(axis, 3);
    for (const Component component : kAllComponents) model.functions[{component, axis.name}] = function;
  }
  return model;
}

/// Stations 2 mm off, weak knowledge of every parameter.
class SampleStartOfTracking : public ::testing::Test {
 protected:
  SampleStartOfTracking() {
    constexpr double kWide = 1e-3;  // m or rad
    for (const double s : stated_sigma(index_, start_)) weight_.push_back(1.0 / (s * s));
    prior_.precision.diagonal().setConstant(1.0 / (kWide * kWide));
    prior_.mean = datum_.reduced(start_);
  }

  struct Solution {
    Eigen::VectorXd z;
    MinimiseSummary summary;
  };
  Solution minimised(MinimiseOptions options) const {
    Solution solution{datum_.reduced(start_), {}};
    solution.summary = minimise(index_, weight_, datum_, prior_, options, solution.z);
    return solution;
  }
  static MinimiseOptions options_with(std::size_t sample_from, int threads) {
    MinimiseOptions options;
    options.sample_from = sample_from;
    options.threads = threads;
    return options;
  }

  Campaign campaign_ = campaign_with_moved_stations();
  MeasurementModel model_{campaign_, splines_of_tracking(campaign_.machine)};
  ReadingIndex index_{model_};
  Eigen::VectorXd start_ = model_.initial_parameters();
  DatumSpace datum_{model_.layout(), campaign_.machine, start_};
  GaussianPrior prior_ = GaussianPrior::none(datum_.size());
  std::vector<double> weight_;
};

TEST_F(SampleStartOfTracking, LeadsToTheMinimumOfOneBlockPerReading) {
  const Solution sampled = minimised(options_with(kAlways, 2));
  MinimiseOptions plain;
  plain.solver = SolverKind::PerReading;
  const Solution reference = minimised(plain);
  ASSERT_TRUE(reference.summary.converged);
  ASSERT_TRUE(sampled.summary.converged);
  EXPECT_NEAR(sampled.summary.final_cost / reference.summary.final_cost, 1.0, 1e-11);
  EXPECT_LT((sampled.z - reference.z).cwiseAbs().maxCoeff(), 1e-9 * reference.z.cwiseAbs().maxCoeff());
}

TEST_F(SampleStartOfTracking, BeginsNearTheMinimum) {
  const Solution sampled = minimised(options_with(kAlways, 1));
  const Solution whole = minimised(options_with(kNever, 1));
  EXPECT_LT(sampled.summary.initial_cost, 1e-3 * whole.summary.initial_cost);
  EXPECT_NEAR(sampled.summary.final_cost / whole.summary.final_cost, 1.0, 1e-11);
}

TEST_F(SampleStartOfTracking, DoesNotDependOnTheNumberOfThreads) {
  const Solution one = minimised(options_with(kAlways, 1));
  for (const int threads : {2, 3}) EXPECT_EQ(minimised(options_with(kAlways, threads)).z, one.z);
}

TEST_F(SampleStartOfTracking, ThereIsNoneWhereTheStartIsNear) {
  const Eigen::VectorXd z = minimised(options_with(kNever, 2)).z;
  EXPECT_FALSE(find_start_on_sample(index_, weight_, datum_, prior_, 2, z));
  EXPECT_TRUE(find_start_on_sample(index_, weight_, datum_, prior_, 2, datum_.reduced(start_)));
}

TEST_F(SampleStartOfTracking, ThereIsNoneWhereAParameterIsUndetermined) {
  prior_ = GaussianPrior::none(datum_.size());
  std::fill_n(weight_.begin(), campaign_.setups[0].readings.size(), 0.0);  // its dead path: no reading
  EXPECT_FALSE(find_start_on_sample(index_, weight_, datum_, prior_, 2, datum_.reduced(start_)));
}

TEST_F(SampleStartOfTracking, OneBlockInSoManyIsSummed) {
  const NormalEquations all = NormalAccumulator(index_, weight_, nullptr, 2).accumulate(start_);
  for (const std::size_t share : {2, 3, 7}) {
    const NormalEquations part = NormalAccumulator(index_, weight_, nullptr, 2, share).accumulate(start_);
    const auto scale = static_cast<double>(share);
    const double count = scale * static_cast<double>(part.observations);
    EXPECT_NEAR(count / static_cast<double>(all.observations), 1.0, 0.1) << share;
    EXPECT_NEAR(scale * part.cost / all.cost, 1.0, 0.3) << share;
    EXPECT_NEAR(scale * part.matrix.trace() / all.matrix.trace(), 1.0, 0.2) << share;
  }
}

}  // namespace
}  // namespace volcal
