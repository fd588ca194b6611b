/// Readings that the w-test suspects, worst first.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/values/residual_sample.h"
#include "volcal/model/observation/channels.h"

namespace volcal::report {
namespace {

constexpr std::size_t kListedSuspects = 200;

/// Chance that the test suspects any reading of a right model with right noise.
double chance_of_any(const FitResult& result) {
  const double of_one = std::erfc(result.outlier_critical_value / std::numbers::sqrt2);
  return -std::expm1(static_cast<double>(result.residuals.size()) * std::log1p(-of_one));
}

}  // namespace

Json outliers_page(const PageInput& input) {
  const FitResult& result = input.result;
  std::vector<const ResidualRecord*> suspects;
  std::size_t removed = 0, left_out = 0;
  for (const ResidualRecord& record : result.residuals) {
    if (is_suspect(record)) suspects.push_back(&record);
    if (record.removed && !record.left_out) ++removed;
    if (record.left_out) ++left_out;
  }
  std::ranges::stable_sort(suspects, std::greater<>(),
                           [](const auto* record) { return std::abs(record->w); });
  Json rows = Json::array();
  for (std::size_t i = 0; i < std::min(kListedSuspects, suspects.size()); ++i) {
    const ResidualRecord& record = *suspects[i];
    const SetupSummary& setup = result.setups[record.setup];
    rows.push_back({{"setup", setup.name},
                    {"instrument", setup.instrument},
                    {"file_line", record.source_line},
                    {"channel", record.channel},
                    {"unit", shown_unit(residual_unit(input.campaign.setups[record.setup],
                                                      static_cast<std::size_t>(record.channel)))},
                    {"residual", rounded(record.residual() * kPerMicro, 4)},
                    {"sigma", rounded(record.sigma * kPerMicro, 3)},
                    {"redundancy", rounded(record.redundancy, 3)},
                    {"w", rounded(record.w, 4)},
                    {"state", record.left_out  ? "left out by the campaign"
                              : record.removed ? "taken out"
                                               : "kept"}});
  }
  return {{"critical", rounded(result.outlier_critical_value, 4)},
          {"chance", rounded(chance_of_any(result), 3)},
          {"observations", result.residuals.size()},
          {"suspect", suspects.size()},
          {"removed", removed},
          {"left_out", left_out},
          {"rows", std::move(rows)}};
}

}  // namespace volcal::report
