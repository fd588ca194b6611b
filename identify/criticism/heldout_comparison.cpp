#include "volcal/identify/criticism/heldout_comparison.h"

#include <algorithm>

#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit.h"

namespace volcal {
namespace {

/// The values of a column whose rows are not marked; a column that the file lacks stays empty.
template <class T>
void drop(std::vector<T>& column, const std::vector<bool>& marked) {
  if (column.empty()) return;
  std::size_t kept = 0;
  for (std::size_t row = 0; row < marked.size(); ++row) {
    if (!marked[row]) column[kept++] = column[row];
  }
  column.resize(kept);
}

}  // namespace

std::vector<std::vector<bool>> judging_rows(const Campaign& campaign, double share) {
  std::vector<std::vector<bool>> rows = heldout_rows(campaign, share);
  for (std::vector<bool>& setup : rows) {
    if (std::ranges::all_of(setup, [](bool held) { return held; })) setup.assign(setup.size(), false);
  }
  return rows;
}

Campaign without_rows(const Campaign& campaign, const std::vector<std::vector<bool>>& left_out) {
  Campaign reduced = campaign;
  for (std::size_t setup = 0; setup < reduced.setups.size(); ++setup) {
    Readings& readings = reduced.setups[setup].readings;
    const std::vector<bool>& marked = left_out[setup];
    for (auto& column : readings.position) drop(column, marked);
    for (auto& column : readings.value) drop(column, marked);
    for (auto& column : readings.given) drop(column, marked);
    for (auto& column : readings.direction) drop(column, marked);
    for (auto& [channel, column] : readings.temperature) drop(column, marked);
    drop(readings.sigma, marked);
    drop(readings.time, marked);
    drop(readings.line, marked);
    drop(readings.run, marked);
    drop(readings.feed, marked);
    drop(readings.source_line, marked);
  }
  return reduced;
}

ModelSpec refittable_model(const FitResult& result) {
  ModelSpec model = result.identified;
  for (auto& [symbol, function] : model.functions) function.coefficients.clear();
  for (const FunctionSummary& summary : result.functions) {
    const auto function = model.functions.find(summary.symbol);
    if (summary.smoothed && function != model.functions.end()) function->second.smoothed = true;
  }
  return model;
}

std::vector<ResidualRecord> heldout_residuals(const Campaign& campaign, const ModelSpec& model,
                                              const std::vector<std::vector<bool>>& heldout,
                                              const HeldOutOptions& options) {
  ModelSpec judged = model;
  if (options.fit) {
    FitOptions fit_options;
    fit_options.threads = options.threads;
    fit_options.progress = options.progress;
    judged = fit(without_rows(campaign, heldout), model, fit_options).identified;
  }
  Evaluation evaluation = evaluate_model(campaign, judged, nullptr, options.threads);
  std::erase_if(evaluation.residuals,
                [&](const ResidualRecord& record) { return !heldout[record.setup][record.row]; });
  return std::move(evaluation.residuals);
}

}  // namespace volcal
