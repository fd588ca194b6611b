#include "volcal/identify/criticism/heldout_comparison.h"

#include <algorithm>

#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit.h"

namespace volcal {
std::vector<std::vector<bool>> judging_rows(const Campaign& campaign, double share) {
  std::vector<std::vector<bool>> rows = heldout_rows(campaign, share);
  for (std::vector<bool>& setup : rows) {
    if (std::ranges::all_of(setup, [](bool held) { return held; })) setup.assign(setup.size(), false);
  }
  return rows;
}

Campaign without_rows(const Campaign& campaign, const std::vector<std::vector<bool>>& marked) {
  Campaign reduced = campaign;
  for (std::size_t i = 0; i < reduced.setups.size(); ++i) {
    Setup& setup = reduced.setups[i];
    std::erase_if(setup.left_out, [&](const LeftOutReading& reading) { return marked[i][reading.row]; });
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      if (!marked[i][row]) continue;
      for (std::size_t channel = 0; channel < setup.readings.channels(); ++channel)
        setup.left_out.push_back({row, channel, "held out"});
    }
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
