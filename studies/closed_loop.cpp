#include "volcal/studies/closed_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/sim/machine/datum.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal::studies {
namespace {

constexpr double kDrift = 0.4e-6;  // m
constexpr double kDriftTime = 600.0;
constexpr double kLineOffset = 0.2e-6;
constexpr double kScale = 0.3e-6;     // relative
constexpr double kToolOffset = 3e-6;  // m

sim::Study closed_loop_study(const ClosedLoopOptions& options, int campaign) {
  const std::vector<Machine> machines = sim::reference_machines();
  sim::Study study;
  study.machine = machines[static_cast<std::size_t>(campaign) % machines.size()];
  study.seed = options.seed + static_cast<std::uint64_t>(campaign);
  sim::Tracking tracking;
  tracking.grid = {options.grid[0], options.grid[1], options.grid[2]};
  if (options.correlated_noise) {
    tracking.noise.drift = kDrift;
    tracking.noise.drift_time = kDriftTime;
    tracking.noise.line = kLineOffset;
  }
  if (options.shared_sources) {
    tracking.length_scale_sigma = kScale;
    for (Tool& tool : study.machine.tools) tool.offset_sigma = kToolOffset;
  }
  study.measurements.emplace_back().settings = tracking;
  return study;
}

double rms_of(const sim::SimulatedCampaign& simulated, const FitResult& result) {
  return validate(simulated.validation, result, 1).figures.rms_after;
}

FitOptions one_thread(NoisePolicy noise) {
  FitOptions options;
  options.threads = 1;
  options.noise = noise;
  return options;
}

double fixed_rms(const sim::SimulatedCampaign& simulated, const std::array<int, 3>& intervals,
                 NoisePolicy noise) {
  ModelSpec model;
  for (const Axis& axis : simulated.campaign.machine.axes) {
    for (const Component component : kAllComponents) {
      FunctionSpec function;
      function.knots = KnotChoice::IntervalCount;
      function.intervals = intervals[index_of(axis.name)];
      model.functions[{component, axis.name}] = function;
    }
  }
  return rms_of(simulated, fit(simulated.campaign, model, one_thread(noise)));
}

double truth_of(const sim::TruthInDatum& truth, const std::array<LocationSymbol, 3>& squareness,
                const ErrorTableRow& row) {
  if (const auto symbol = row.symbol.motion()) return truth.value(*symbol, row.position);
  for (std::size_t i = 0; i < squareness.size(); ++i) {
    if (row.symbol == squareness[i]) return truth.squareness()[i];
  }
  return std::numeric_limits<double>::quiet_NaN();
}

std::map<std::string, double> table_coverage(const sim::SimulatedCampaign& simulated,
                                             const FitResult& result) {
  const sim::TruthInDatum truth(simulated.truth);
  const auto squareness = result.machine.datum.squareness();
  std::map<std::string, std::pair<int, int>> counts;
  for (const ErrorTableRow& row : error_table(result)) {
    if (row.u == 0.0 || row.extrapolated) continue;
    auto& [inside, all] = counts[row.symbol.name()];
    inside += std::abs(row.value - truth_of(truth, squareness, row)) <= row.U95 ? 1 : 0;
    ++all;
  }
  std::map<std::string, double> coverage;
  for (const auto& [symbol, count] : counts)
    coverage[symbol] = static_cast<double>(count.first) / count.second;
  return coverage;
}

ClosedLoopCampaign run_campaign(const ClosedLoopOptions& options, int campaign) {
  const sim::Study study = closed_loop_study(options, campaign);
  const sim::SimulatedCampaign simulated = sim::simulate(study);
  const FitResult result = fit(simulated.campaign, ModelSpec{}, one_thread(NoisePolicy::Automatic));
  const Validation validation = validate(simulated.validation, result, 1);
  ClosedLoopCampaign row;
  row.structure = study.machine.structure.code;
  for (const Axis& axis : study.machine.axes)
    row.longest_travel = std::max(row.longest_travel, axis.travel());
  row.seed = study.seed;
  row.rms_before = validation.figures.rms_before;
  row.rms_after = validation.figures.rms_after;
  row.reduced_chi2 = result.chi2 / result.dof;
  row.coverage = table_coverage(simulated, result);
  row.white_rms_after = std::numeric_limits<double>::quiet_NaN();
  if (options.correlated_noise) {
    const FitResult white = fit(simulated.campaign, ModelSpec{}, one_thread(NoisePolicy::White));
    row.white_coverage = table_coverage(simulated, white);
    row.white_rms_after = rms_of(simulated, white);
  }
  const NoisePolicy of_fixed = options.correlated_noise ? NoisePolicy::Automatic : NoisePolicy::White;
  for (std::size_t i = 0; i < kFixedKnotSets.size(); ++i) {
    row.rms_fixed[i] = options.fixed_knots ? fixed_rms(simulated, kFixedKnotSets[i], of_fixed)
                                           : std::numeric_limits<double>::quiet_NaN();
  }
  return row;
}

}  // namespace

double ClosedLoopCampaign::best_fixed() const { return *std::ranges::min_element(rms_fixed); }

double mean_coverage(const std::map<std::string, double>& coverage) {
  const double sum = std::accumulate(coverage.begin(), coverage.end(), 0.0,
                                     [](double total, const auto& entry) { return total + entry.second; });
  return sum / static_cast<double>(coverage.size());
}

std::vector<ClosedLoopCampaign> closed_loop(const ClosedLoopOptions& options) {
  std::vector<ClosedLoopCampaign> rows(static_cast<std::size_t>(options.campaigns));
  int done = 0;
  std::mutex reporting;
  run_parallel(rows.size(), thread_count(options.threads), [&](std::size_t i) {
    rows[i] = run_campaign(options, static_cast<int>(i));
    const std::lock_guard lock(reporting);
    ++done;
    if (options.progress) options.progress(done, options.campaigns);
  });
  return rows;
}

}  // namespace volcal::studies
