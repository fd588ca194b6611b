#include "volcal/identify/report/error_budget_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "volcal/identify/report/text_tables.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr std::size_t kShownContributions = 12;

std::vector<std::string> cells_of(const BudgetLine& line, double coverage_factor) {
  return {line.name,
          line.depends_on,
          fixed_number(line.rms / kMicro, 2),
          fixed_number(line.max / kMicro, 2),
          fixed_number(100.0 * line.share, 1),
          fixed_number(coverage_factor * line.u_rms / kMicro, 2)};
}

nlohmann::ordered_json line_json(const BudgetLine& line) {
  nlohmann::ordered_json json = {{"name", line.name}};
  if (!line.depends_on.empty()) json["depends_on"] = line.depends_on;
  json["rms_um"] = line.rms / kMicro;
  json["max_um"] = line.max / kMicro;
  json["share_percent"] = 100.0 * line.share;
  json["u_rms_um"] = line.u_rms / kMicro;
  return json;
}

}  // namespace

std::string error_budget_text(const ErrorBudget& budget, const std::string& tool, double coverage_factor,
                              bool verbose) {
  const std::vector<TextColumn> columns = {{"", Align::Left}, {"depends on", Align::Left},
                                           {"RMS [um]"},      {"max [um]"},
                                           {"share [%]"},     {"U95 [um]"}};
  TextTable causes(columns, "Error in the volume, tool " + tool + ", by cause");
  for (const BudgetLine& line : budget.causes) causes.add_row(cells_of(line, coverage_factor));
  causes.add_row(cells_of(budget.total, coverage_factor));
  const std::size_t shown =
      verbose ? budget.contributions.size() : std::min(kShownContributions, budget.contributions.size());
  TextTable parts(columns, "By error, largest first");
  for (std::size_t i = 0; i < shown; ++i) parts.add_row(cells_of(budget.contributions[i], coverage_factor));
  std::string text = causes.text() + parts.text();
  if (shown < budget.contributions.size())
    text += fmt::format("{} smaller ones: --verbose\n", budget.contributions.size() - shown);
  return text;
}

nlohmann::ordered_json error_budget_json(const ErrorBudget& budget) {
  nlohmann::ordered_json json = {{"total", line_json(budget.total)}};
  json["causes"] = nlohmann::ordered_json::array();
  json["contributions"] = nlohmann::ordered_json::array();
  for (const BudgetLine& line : budget.causes) json["causes"].push_back(line_json(line));
  for (const BudgetLine& line : budget.contributions) json["contributions"].push_back(line_json(line));
  return json;
}

}  // namespace volcal
