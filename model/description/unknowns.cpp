#include "volcal/model/description/unknowns.h"

#include <algorithm>

namespace volcal {
namespace {

void add_motions(AxisName axis, std::vector<ErrorSymbol>& symbols) {
  for (const Component component : kAllComponents) symbols.push_back({component, axis});
}

bool is_along_axis(const LocationSymbol& symbol) {
  return !is_rotation(symbol.component) && direction_of(symbol.component) == direction_of(symbol.axis);
}

}  // namespace

std::vector<AxisName> linear_axes(const Machine& machine) {
  std::vector<AxisName> axes;
  for (const AxisName axis : {AxisName::X, AxisName::Y, AxisName::Z}) {
    if (machine.has_axis(axis)) axes.push_back(axis);
  }
  return axes;
}

std::vector<ErrorSymbol> linear_axis_motions(const Machine& machine) {
  std::vector<ErrorSymbol> symbols;
  for (const AxisName axis : linear_axes(machine)) add_motions(axis, symbols);
  return symbols;
}

std::vector<LocationSymbol> squareness_errors(const Machine& machine) {
  std::vector<LocationSymbol> symbols;
  for (const LocationSymbol& symbol : machine.datum.squareness()) {
    if (machine.has_axis(symbol.axis)) symbols.push_back(symbol);
  }
  return symbols;
}

std::vector<LocationSymbol> possible_locations(const Machine& machine) {
  std::vector<LocationSymbol> symbols = squareness_errors(machine);
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) continue;
    for (const Component component : kAllComponents) {
      const LocationSymbol symbol{component, axis.name};
      if (!is_along_axis(symbol)) symbols.push_back(symbol);
    }
  }
  return symbols;
}

std::vector<ErrorSymbol> modelled_motions(const Machine& machine, const ModelSpec& model) {
  std::vector<ErrorSymbol> symbols;
  for (const Axis& axis : machine.axes) add_motions(axis.name, symbols);
  std::erase_if(symbols, [&](const ErrorSymbol& symbol) {
    return is_rotary(symbol.axis) && !model.functions.contains(symbol);
  });
  return symbols;
}

std::vector<LocationSymbol> modelled_locations(const Machine& machine, const ModelSpec& model) {
  std::vector<LocationSymbol> symbols = squareness_errors(machine);
  std::erase_if(symbols, [&](const LocationSymbol& symbol) {
    return std::ranges::find(model.locations_off, symbol) != model.locations_off.end();
  });
  for (const auto& [symbol, value] : model.locations) {
    if (is_rotary(symbol.axis) && machine.has_axis(symbol.axis)) symbols.push_back(symbol);
  }
  return symbols;
}

}  // namespace volcal
