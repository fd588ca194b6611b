/// Squareness of the linear axes, location and orientation of rotary axes.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/unknowns.h"
#include "volcal/model/kinematics/rotary_datum.h"

namespace volcal::report {
namespace {

std::string meaning_of_location(LocationSymbol symbol) {
  const char axis = letter_of(symbol.axis);
  if (is_rotary(symbol.axis)) {
    return is_rotation(symbol.component)
               ? fmt::format("orientation of the {} axis about {}", axis,
                             "xyz"[direction_of(symbol.component)])
               : fmt::format("location of the {} axis in {}", axis, "xyz"[direction_of(symbol.component)]);
  }
  if (is_parallel(symbol.axis))
    return fmt::format("direction of {} about {}; parallelism to {} is the difference", axis,
                       "xyz"[direction_of(symbol.component)], letter_of(main_axis_of(symbol.axis)));
  const int other = 3 - direction_of(symbol.component) - direction_of(symbol.axis);
  return fmt::format("squareness of {} to {}", axis, "XYZ"[other]);
}

/// What a squareness amounts to over the whole travel of its axis, m; 0 for other location errors.
double over_travel(const Machine& machine, LocationSymbol symbol, double value) {
  return is_rotary(symbol.axis) ? 0.0 : value * machine.axis(symbol.axis).travel();
}

Json identified(const FitResult& result, const ParameterBlock& block) {
  const LocationSymbol symbol = *block.location;
  const double value = result.parameters[block.offset];
  const double u = std::sqrt(parameter_variance(result, block.offset));
  const Observability* error = find_observability(result, symbol);
  const bool visible = error == nullptr || error->visible;
  Json row = {{"symbol", symbol.name()},
              {"axis", axis_letter(symbol.axis)},
              {"meaning", meaning_of_location(symbol)},
              {"unit", is_rotation(symbol.component) ? "µrad" : "µm"},
              {"state", visible ? "identified" : "invisible"},
              {"reason", visible ? "" : explanation(error->cause).reason},
              {"value", rounded(value * kPerMicro, kDigitsBesideU)},
              {"u", rounded(u * kPerMicro, kDigitsBesideU)},
              {"U95", rounded(result.coverage_factor * u * kPerMicro, kDigitsBesideU)}};
  if (!is_rotary(symbol.axis)) {
    row["travel_mm"] = rounded(result.machine.axis(symbol.axis).travel() / kMetrePerMillimetre, 7);
    row["over_travel_um"] = rounded(over_travel(result.machine, symbol, value) * kPerMicro);
  }
  return row;
}

Json without_value(LocationSymbol symbol, const char* state, const std::string& reason = "") {
  return {{"symbol", symbol.name()},
          {"axis", axis_letter(symbol.axis)},
          {"meaning", meaning_of_location(symbol)},
          {"unit", is_rotation(symbol.component) ? "µrad" : "µm"},
          {"state", state},
          {"reason", reason}};
}

/// Of rotary axes with identified locations: what no reading can tell from other errors.
std::vector<LocationSymbol> zero_by_convention(const FitResult& result) {
  std::vector<LocationSymbol> symbols = possible_locations(result.machine);
  const std::vector<LocationSymbol> independent = independent_locations(result.machine);
  std::erase_if(symbols, [&](const LocationSymbol& symbol) {
    const bool axis_is_located = std::ranges::any_of(result.layout.blocks, [&](const ParameterBlock& block) {
      return block.location && block.location->axis == symbol.axis;
    });
    return !is_rotary(symbol.axis) || !axis_is_located || result.layout.find_location(symbol) ||
           std::ranges::find(independent, symbol) != independent.end();
  });
  return symbols;
}

}  // namespace

Json locations_page(const PageInput& input) {
  const FitResult& result = input.result;
  Json rows = Json::array();
  for (const ParameterBlock& block : result.layout.blocks) {
    if (block.location) rows.push_back(identified(result, block));
  }
  for (const LocationSymbol symbol : result.identified.locations_off) {
    rows.push_back(without_value(symbol, "off"));
  }
  for (const LocationSymbol symbol : zero_by_convention(result))
    rows.push_back(without_value(symbol, "convention",
                                 "no reading tells it from other locations and the place of the workpiece"));
  return {{"primary", axis_letter(result.machine.datum.primary)},
          {"secondary", axis_letter(result.machine.datum.secondary)},
          {"coverage", rounded(result.coverage_factor)},
          {"rows", std::move(rows)}};
}

}  // namespace volcal::report
