#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/report/text/text_tables.h"
#include "volcal/identify/report/values/error_range.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"
#include "volcal/python/result.h"

namespace volcal::python {
namespace {

constexpr double kPlotWidth = 160.0, kPlotHeight = 28.0;  // px

/// An error over its travel, mean of both directions.
std::string curve(const std::vector<ErrorTableRow>& table, const MachineError& error) {
  std::vector<const ErrorTableRow*> rows;
  for (const ErrorTableRow& row : table) {
    if (row.symbol == error && row.axis && row.direction == 0) rows.push_back(&row);
  }
  if (rows.size() < 2) return {};
  const auto by_value = [](const ErrorTableRow* row) { return row->value; };
  const double low = by_value(*std::ranges::min_element(rows, {}, by_value));
  const double high = by_value(*std::ranges::max_element(rows, {}, by_value));
  const double begin = rows.front()->position, range = rows.back()->position - begin;
  std::string points;
  for (const ErrorTableRow* row : rows) {
    const double y = high > low ? (high - row->value) / (high - low) : 0.5;
    points += fmt::format("{:.1f},{:.1f} ", kPlotWidth * (row->position - begin) / range,
                          1.0 + (kPlotHeight - 2.0) * y);
  }
  return fmt::format(
      "<svg width=\"{0:g}\" height=\"{1:g}\" role=\"img\" aria-label=\"{2} over its travel\"><polyline "
      "points=\"{3}\" "
      "fill=\"none\" stroke=\"#1f5f99\" stroke-width=\"1.5\"/></svg>",
      kPlotWidth, kPlotHeight, escaped(error.name()), points);
}

std::string unit_of(const FitResult& result, const MachineError& error, double& si_per_unit) {
  const ParameterBlock* block = result.layout.find_block(error);
  si_per_unit = block != nullptr ? block->si_per_unit[0] : kMicro;
  if (block != nullptr) return block->units[0];
  return error.is_angle() ? "urad" : "um";
}

std::string error_row(const FitResult& result, const std::vector<ErrorTableRow>& table,
                      const Observability& error) {
  double si_per_unit = 1.0;
  const std::string unit = unit_of(result, error.symbol, si_per_unit);
  const report::ErrorRange range = report::error_range(result, table, error);
  const auto number = [&](double si) { return fixed_number(si / si_per_unit, 2); };
  return fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
                     escaped(error.symbol.name()), escaped(unit), error.visible ? number(range.low) : "-",
                     error.visible ? number(range.high) : "not visible", number(range.expanded),
                     fixed_number(error.visible_fraction, 2), curve(table, error.symbol));
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string html;
  for (const char c : text) {
    html += c == '<' ? std::string("&lt;") : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  }
  return html;
}

std::string result_html(const Result& of) {
  const FitResult& result = of.result;
  const std::vector<ErrorTableRow> table = error_table(result);
  std::string rows;
  for (const Observability& error : result.rank.errors) rows += error_row(result, table, error);
  std::string remarks;
  for (const std::string& each : sentences(result.findings)) remarks += "<li>" + escaped(each) + "</li>";
  return fmt::format(
      "<div><p><b>{}</b> ({}): status {}, sigma0 "
      "{:.3f}</p><table><thead><tr><th>error</th><th>unit</th><th>min</th>"
      "<th>max</th><th>U95 at most</th><th>visible fraction</th><th>over the "
      "travel</th></tr></thead><tbody>{}</tbody>"
      "</table>{}</div>",
      escaped(result.machine.name), escaped(result.machine.structure.code), to_string(result.status),
      result.sigma0, rows, remarks.empty() ? "" : "<ul>" + remarks + "</ul>");
}

}  // namespace volcal::python
