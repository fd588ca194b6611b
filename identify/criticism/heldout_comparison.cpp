#include "volcal/identify/criticism/heldout_comparison.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <stdexcept>
#include <utility>

#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/statistics/normal.h"

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

namespace {

bool is_same_reading(const ResidualRecord& a, const ResidualRecord& b) {
  return a.setup == b.setup && a.row == b.row && a.channel == b.channel;
}

/// Sums over readings that neither adjustment has taken out.
struct GainSums {
  double without = 0.0, with = 0.0;  ///< chi-squared
  double moved = 0.0;                ///< of the squares of the differences d
  double readings = 0.0;
  /// Of d e by setup and line, e the residuals of either model.
  std::map<std::pair<std::size_t, int>, std::pair<double, double>> by_line;
};

GainSums gain_sums(const Campaign& campaign, const std::vector<ResidualRecord>& without,
                   const std::vector<ResidualRecord>& with) {
  if (without.size() != with.size())
    throw std::invalid_argument("heldout_gain: residuals of different readings");
  const auto groups = heldout_groups(campaign, kShareOfJudging);
  GainSums sums;
  for (std::size_t i = 0; i < with.size(); ++i) {
    const ResidualRecord &before = without[i], &after = with[i];
    if (!is_same_reading(before, after))
      throw std::invalid_argument("heldout_gain: residuals of different readings");
    if (before.removed || after.removed) continue;
    const double r = before.residual() / before.sigma, left = after.residual() / after.sigma;
    const double d = r - left;
    sums.without += r * r;
    sums.with += left * left;
    sums.moved += d * d;
    sums.readings += 1.0;
    auto& [of_without, of_with] = sums.by_line[{after.setup, groups[after.setup][after.row]}];
    of_without += d * r;
    of_with += d * left;
  }
  return sums;
}

}  // namespace

HeldOutGain heldout_gain(const Campaign& campaign, const std::vector<ResidualRecord>& without,
                         const std::vector<ResidualRecord>& with) {
  const GainSums sums = gain_sums(campaign, without, with);
  if (!(sums.moved > 0.0)) return {};
  const bool is_nearer = sums.with < sums.without;
  double by_line = 0.0;
  for (const auto& [line, products] : sums.by_line) {
    const double product = is_nearer ? products.second : products.first;
    by_line += product * product;
  }
  const double variance = std::max(std::min(sums.with, sums.without) / sums.readings, by_line / sums.moved);
  return {sums.without - sums.with, kCoverageFactor * kCoverageFactor * variance};
}

}  // namespace volcal
