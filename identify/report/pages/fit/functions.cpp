/// The error functions of all axes with their 95 % bands.

#include <fmt/format.h>

#include <map>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/report/numbers.h"
#include "volcal/identify/words/sentences.h"

namespace volcal::report {
namespace {

constexpr int kPlottedPositions = 81;

const char* meaning(ErrorSymbol symbol) {
  if (symbol.is_positioning()) return "positioning";
  if (is_rotary(symbol.axis)) return is_rotation(symbol.component) ? "tilt" : "radial or axial motion";
  if (symbol.is_straightness()) return "straightness";
  return direction_of(symbol.component) == direction_of(symbol.axis) ? "roll" : "tilt (pitch or yaw)";
}

/// Plotted rows of one function by direction of approach (0 = mean of both).
struct FunctionRows {
  std::map<int, std::vector<const ErrorTableRow*>> by_direction;
};

Json curve(int direction, const std::vector<const ErrorTableRow*>& rows) {
  std::vector<double> value;
  std::vector<double> u95;
  for (const ErrorTableRow* row : rows) {
    value.push_back(row->value);
    u95.push_back(row->U95);
  }
  return {{"direction", direction},
          {"value", rounded_array(value, kPerMicro)},
          {"U95", rounded_array(u95, kPerMicro, 4)}};
}

void add_curves(const FunctionRows& rows, AxisName axis, Json& json) {
  Json position = Json::array();
  Json extrapolated = Json::array();
  for (const ErrorTableRow* row : rows.by_direction.begin()->second) {
    position.push_back(rounded(row->position * position_factor(axis), 7));
    extrapolated.push_back(row->extrapolated ? 1 : 0);
  }
  json["position"] = std::move(position);
  json["extrapolated"] = std::move(extrapolated);
  json["curves"] = Json::array();
  for (const auto& [direction, list] : rows.by_direction) json["curves"].push_back(curve(direction, list));
}

/// None for an error that is nothing but its reversal.
void add_knots(const FitResult& result, ErrorSymbol symbol, Json& json) {
  std::vector<double> knots;
  if (result.layout.find(symbol)) knots = result.identified.function(symbol).breakpoints;
  json["knots"] = rounded_array(knots, position_factor(symbol.axis), 7);
}

Json function_json(const FitResult& result, ErrorSymbol symbol, const FunctionRows* rows) {
  Json json;
  json["symbol"] = symbol.name();
  json["axis"] = axis_letter(symbol.axis);
  json["component"] = static_cast<int>(index_of(symbol.component));
  json["unit"] = is_rotation(symbol.component) ? "µrad" : "µm";
  json["meaning"] = meaning(symbol);
  const Observability* error = find_observability(result, symbol);
  if (rows == nullptr) {
    json["state"] = "off";
    return json;
  }
  const bool visible = error == nullptr || error->visible;
  json["state"] = visible ? "identified" : "invisible";
  const Explanation words = visible ? Explanation{} : explanation(error->cause);
  json["reason"] = words.reason;
  json["remedy"] = words.remedy;
  add_curves(*rows, symbol.axis, json);
  add_knots(result, symbol, json);
  return json;
}

}  // namespace

Json functions_page(const PageInput& input) {
  const FitResult& result = input.result;
  ErrorTableOptions options;
  options.positions = kPlottedPositions;
  const std::vector<ErrorTableRow> table = error_table(result, options);
  std::map<MachineError, FunctionRows> by_symbol;
  for (const ErrorTableRow& row : table) {
    if (row.axis) by_symbol[row.symbol].by_direction[row.direction].push_back(&row);
  }
  Json axes = Json::array();
  Json functions = Json::array();
  for (const Axis& axis : result.machine.axes) {
    const double factor = position_factor(axis.name);
    axes.push_back({{"name", axis_letter(axis.name)},
                    {"unit", position_unit(axis.name).suffix},
                    {"range", {rounded(axis.travel_min * factor, 7), rounded(axis.travel_max * factor, 7)}}});
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      const auto rows = by_symbol.find(symbol);
      functions.push_back(function_json(result, symbol, rows == by_symbol.end() ? nullptr : &rows->second));
    }
  }
  return {{"coverage", rounded(result.coverage_factor)},
          {"axes", std::move(axes)},
          {"functions", std::move(functions)}};
}

}  // namespace volcal::report
