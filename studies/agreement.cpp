#include "volcal/studies/agreement.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/montecarlo/montecarlo.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal::studies {
namespace {

constexpr std::array<int, 3> kIntervals = {12, 9, 8};  // of the knots, X Y Z: fine enough for the machine
constexpr int kBatch = 64;                             // campaigns whose values are held at once

sim::Study repeated_study(const AgreementOptions& options, int campaign) {
  sim::Study study;
  study.machine = sim::reference_machines().at(static_cast<std::size_t>(options.structure));
  study.seed = options.seed;
  study.noise_seed = options.seed + static_cast<std::uint64_t>(campaign);
  study.validation.points = 1;
  sim::Tracking tracking;
  tracking.grid = {options.grid[0], options.grid[1], options.grid[2]};
  study.measurements.emplace_back().settings = tracking;
  return study;
}

ModelSpec model_without_smoothing(const Machine& machine) {
  ModelSpec model;
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents) {
      FunctionSpec function;
      function.knots = KnotChoice::IntervalCount;
      function.intervals = kIntervals[index_of(axis.name)];
      model.functions[{component, axis.name}] = function;
    }
  }
  return model;
}

struct RepeatedFit {
  Campaign campaign;
  FitResult result;
  std::vector<ErrorTableRow> values;
};

RepeatedFit repeated_fit(const AgreementOptions& options, int campaign) {
  RepeatedFit repeated{sim::simulate(repeated_study(options, campaign)).campaign, {}, {}};
  FitOptions fitting;
  fitting.threads = 1;
  fitting.noise = NoisePolicy::White;
  repeated.result = fit(repeated.campaign, model_without_smoothing(repeated.campaign.machine), fitting);
  repeated.values = error_table(repeated.result);
  std::erase_if(repeated.values, [](const ErrorTableRow& row) { return row.u == 0.0; });
  return repeated;
}

/// u of the draws over u of linear propagation, of every table value.
std::vector<double> montecarlo_ratios(const AgreementOptions& options) {
  const RepeatedFit first = repeated_fit(options, 0);
  MonteCarloOptions drawing;
  drawing.path = DrawPath::Chord;
  drawing.draws = options.draws;
  drawing.seed = options.seed;
  drawing.threads = options.threads;
  drawing.grid_per_axis = 0;
  MonteCarloStudy study(first.campaign, first.result, drawing);
  while (!study.done()) study.run_block();
  std::vector<double> ratios;
  for (const QuantityResult& each : study.result().quantities) {
    if (each.quantity.kind == QuantityKind::TableValue) ratios.push_back(each.u / each.u_linear);
  }
  return ratios;
}

/// Sums over campaigns, each value from that of the first.
struct ScatterSums {
  double from = 0.0, sum = 0.0, squares = 0.0, variances = 0.0;

  void add(const ErrorTableRow& row) {
    const double deviation = row.value - from;
    sum += deviation;
    squares += deviation * deviation;
    variances += row.u * row.u;
  }
};

}  // namespace

std::vector<AgreedValue> agreement(const AgreementOptions& options) {
  const std::vector<double> ratios = montecarlo_ratios(options);
  std::vector<AgreedValue> values;
  std::vector<ScatterSums> sums;
  for (int begin = 0; begin < options.campaigns; begin += kBatch) {
    std::vector<std::vector<ErrorTableRow>> batch(
        static_cast<std::size_t>(std::min(kBatch, options.campaigns - begin)));
    run_parallel(batch.size(), thread_count(options.threads), [&](std::size_t i) {
      batch[i] = repeated_fit(options, begin + static_cast<int>(i)).values;
    });
    for (const std::vector<ErrorTableRow>& rows : batch) {
      if (rows.size() != ratios.size()) throw std::logic_error("campaigns with other table values");
      if (sums.empty()) {
        for (const ErrorTableRow& row : rows) {
          sums.push_back({row.value});
          values.push_back({row.symbol});
        }
      }
      for (std::size_t k = 0; k < rows.size(); ++k) sums[k].add(rows[k]);
    }
    if (options.progress) options.progress(begin + static_cast<int>(batch.size()), options.campaigns);
  }
  const double count = options.campaigns;
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k].u_linear = std::sqrt(sums[k].variances / count);
    values[k].u_montecarlo = ratios[k] * values[k].u_linear;
    values[k].u_scatter = std::sqrt((sums[k].squares - sums[k].sum * sums[k].sum / count) / (count - 1.0));
  }
  return values;
}

}  // namespace volcal::studies
