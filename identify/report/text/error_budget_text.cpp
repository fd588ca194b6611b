#include "volcal/identify/report/text/error_budget_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "volcal/identify/report/text/text_tables.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/unknowns.h"

namespace volcal {
namespace {

constexpr std::size_t kShownContributions = 12;

std::vector<std::string> cells_of(const BudgetLine& line, double coverage_factor) {
  return {line.name,
          line.depends_on_text(),
          fixed_number(line.rms / kMicro, 2),
          fixed_number(line.max / kMicro, 2),
          fixed_number(100.0 * line.share, 1),
          line.u_rms > 0.0 ? fixed_number(coverage_factor * line.u_rms / kMicro, 2) : "-"};
}

nlohmann::ordered_json line_json(const BudgetLine& line) {
  nlohmann::ordered_json json = {{"name", line.name}};
  if (!line.depends_on.empty()) json["depends_on"] = line.depends_on_text();
  json["rms_um"] = line.rms / kMicro;
  json["max_um"] = line.max / kMicro;
  json["share_percent"] = 100.0 * line.share;
  json["u_rms_um"] = line.u_rms > 0.0 ? nlohmann::ordered_json(line.u_rms / kMicro) : nullptr;
  return json;
}

template <class Symbol>
const Symbol* symbol_of(const BudgetLine& line) {
  return line.source ? std::get_if<Symbol>(&*line.source) : nullptr;
}

/// Width of the band of an error, SI; none where it has no tolerance.
std::optional<double> width_of_error(const Tolerances& tolerances, const BudgetLine& line) {
  const auto width_in = [](const auto& widths, const auto* symbol) -> std::optional<double> {
    const auto found = symbol != nullptr ? widths.find(*symbol) : widths.end();
    return found != widths.end() ? std::optional(found->second) : std::nullopt;
  };
  const auto width = width_in(tolerances.functions, symbol_of<ErrorSymbol>(line));
  return width ? width : width_in(tolerances.squareness, symbol_of<LocationSymbol>(line));
}

std::string unit_of_error(const BudgetLine& line) {
  const auto* symbol = symbol_of<ErrorSymbol>(line);
  return symbol != nullptr ? std::string(edge_unit(symbol->component)) : "urad";
}

std::vector<std::string> design_cells(const BudgetLine& line, const Tolerances& tolerances) {
  const auto width = width_of_error(tolerances, line);
  return {line.name, line.depends_on_text(),
          width ? short_number(*width / kMicro) + " " + unit_of_error(line) : std::string(),
          fixed_number(line.expected_rms() / kMicro, 2), fixed_number(100.0 * line.expected_share, 1)};
}

/// Errors of the linear axes that no tolerance bounds.
std::vector<std::string> without_tolerance(const Machine& machine, const Tolerances& tolerances) {
  std::vector<std::string> names;
  for (const ErrorSymbol symbol : linear_axis_motions(machine)) {
    if (!tolerances.functions.contains(symbol)) names.push_back(symbol.name());
  }
  for (const LocationSymbol symbol : squareness_errors(machine)) {
    if (!tolerances.squareness.contains(symbol)) names.push_back(symbol.name());
  }
  return names;
}

nlohmann::ordered_json design_line_json(const BudgetLine& line, const Tolerances& tolerances) {
  nlohmann::ordered_json json = {{"name", line.name}};
  if (!line.depends_on.empty()) json["depends_on"] = line.depends_on_text();
  if (const auto width = width_of_error(tolerances, line))
    json["tolerance_" + unit_of_error(line)] = *width / kMicro;
  json["expected_rms_um"] = line.expected_rms() / kMicro;
  json["expected_share_percent"] = 100.0 * line.expected_share;
  return json;
}

std::string letters(const std::vector<AxisName>& axes) {
  std::string text;
  for (const AxisName axis : axes) text += (text.empty() ? "" : ", ") + std::string(1, letter_of(axis));
  return text;
}

/// Over which positions of rotary axes the budget is, and what of their errors is not in it.
std::string rotary_axes_text(const ErrorBudget& budget, const std::string& why_at_rest) {
  std::string text;
  if (!budget.turned.empty())
    text += fmt::format("over the travel of {} as well, a turn at most, in workpiece coordinates\n",
                        letters(budget.turned));
  if (!budget.at_rest.empty())
    text +=
        fmt::format("! {} at 0 in all poses: {}, and are not in it\n", letters(budget.at_rest), why_at_rest);
  return text;
}

nlohmann::ordered_json letters_json(const std::vector<AxisName>& axes) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const AxisName axis : axes) json.push_back(std::string(1, letter_of(axis)));
  return json;
}

}  // namespace

std::string design_budget_text(const ErrorBudget& budget, const Machine& machine,
                               const Tolerances& tolerances, const std::string& tool, bool verbose) {
  const std::vector<TextColumn> columns = {
      {"", Align::Left}, {"depends on", Align::Left}, {"tolerance"}, {"RMS [um]"}, {"share [%]"}};
  TextTable causes(columns, "Expected error in the volume, " + functional_point_words(tool) + ", by cause");
  for (const BudgetLine& line : budget.causes) causes.add_row(design_cells(line, tolerances));
  causes.add_row(design_cells(budget.total, tolerances));
  const std::size_t shown =
      verbose ? budget.contributions.size() : std::min(kShownContributions, budget.contributions.size());
  TextTable parts(columns, "By error, largest first");
  for (std::size_t i = 0; i < shown; ++i) parts.add_row(design_cells(budget.contributions[i], tolerances));
  std::string text = causes.text() + parts.text();
  if (shown < budget.contributions.size())
    text += fmt::format("{} smaller ones: --verbose\n", budget.contributions.size() - shown);
  if (budget.rms_95 > 0.0)
    text += fmt::format("RMS of the volume that 95 % of such machines do not exceed: {} um\n",
                        fixed_number(budget.rms_95 / kMicro, 2));
  text += "u = tolerance / (2 sqrt 3); over the travel a slope and two waves, straightness two waves\n";
  text += rotary_axes_text(budget, "their errors have no tolerance");
  const auto missing = without_tolerance(machine, tolerances);
  if (!missing.empty())
    text += fmt::format("! without a tolerance, counted as free of error: {}\n", fmt::join(missing, ", "));
  return text;
}

nlohmann::ordered_json design_budget_json(const ErrorBudget& budget, const Machine& machine,
                                          const Tolerances& tolerances) {
  nlohmann::ordered_json json = {{"total", design_line_json(budget.total, tolerances)}};
  if (budget.rms_95 > 0.0) json["rms_95_um"] = budget.rms_95 / kMicro;
  json["causes"] = nlohmann::ordered_json::array();
  json["contributions"] = nlohmann::ordered_json::array();
  for (const BudgetLine& line : budget.causes) json["causes"].push_back(design_line_json(line, tolerances));
  for (const BudgetLine& line : budget.contributions)
    json["contributions"].push_back(design_line_json(line, tolerances));
  json["without_tolerance"] = without_tolerance(machine, tolerances);
  json["rotary_axes_at_0"] = letters_json(budget.at_rest);
  return json;
}

std::string error_budget_text(const ErrorBudget& budget, const std::string& tool, double coverage_factor,
                              bool verbose) {
  const std::vector<TextColumn> columns = {{"", Align::Left}, {"depends on", Align::Left},
                                           {"RMS [um]"},      {"max [um]"},
                                           {"share [%]"},     {"U95 [um]"}};
  TextTable causes(columns, "Error in the volume, " + functional_point_words(tool) + ", by cause");
  for (const BudgetLine& line : budget.causes) causes.add_row(cells_of(line, coverage_factor));
  causes.add_row(cells_of(budget.total, coverage_factor));
  const std::size_t shown =
      verbose ? budget.contributions.size() : std::min(kShownContributions, budget.contributions.size());
  TextTable parts(columns, "By error, largest first");
  for (std::size_t i = 0; i < shown; ++i) parts.add_row(cells_of(budget.contributions[i], coverage_factor));
  std::string text = causes.text() + parts.text();
  if (shown < budget.contributions.size())
    text += fmt::format("{} smaller ones: --verbose\n", budget.contributions.size() - shown);
  return text + rotary_axes_text(budget, "their errors were not identified");
}

nlohmann::ordered_json error_budget_json(const ErrorBudget& budget) {
  nlohmann::ordered_json json = {{"total", line_json(budget.total)}};
  json["causes"] = nlohmann::ordered_json::array();
  json["contributions"] = nlohmann::ordered_json::array();
  for (const BudgetLine& line : budget.causes) json["causes"].push_back(line_json(line));
  for (const BudgetLine& line : budget.contributions) json["contributions"].push_back(line_json(line));
  json["rotary_axes_turned"] = letters_json(budget.turned);
  json["rotary_axes_at_0"] = letters_json(budget.at_rest);
  return json;
}

}  // namespace volcal
