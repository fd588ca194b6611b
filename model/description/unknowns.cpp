#include "volcal/model/description/unknowns.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

namespace volcal {
namespace {

constexpr double kNearlyAFullTurn = 350.0 / 180.0 * std::numbers::pi;
constexpr double kLeastMoved = 1e-3;  // of the travel

/// Least and largest position of readings that are not left out.
std::pair<double, double> measured_ends_of(const Campaign& campaign, AxisName axis) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Setup& setup : campaign.setups) {
    const std::vector<bool> left_out = setup.rows_left_out();
    const std::vector<double>& position = setup.readings.position[index_of(axis)];
    for (std::size_t row = 0; row < position.size(); ++row) {
      if (left_out[row]) continue;
      least = std::min(least, position[row]);
      most = std::max(most, position[row]);
    }
  }
  return {least, most};
}

bool moves(const std::pair<double, double>& ends, const Axis& axis) {
  return ends.second - ends.first > kLeastMoved * axis.travel();
}

void add_motions(AxisName axis, std::vector<ErrorSymbol>& symbols) {
  for (const Component component : kAllComponents) symbols.push_back({component, axis});
}

bool is_along_axis(const LocationSymbol& symbol) {
  return !is_rotation(symbol.component) && direction_of(symbol.component) == direction_of(symbol.axis);
}

}  // namespace

std::vector<ErrorSymbol> linear_axis_motions(const Machine& machine) {
  std::vector<ErrorSymbol> symbols;
  for (const AxisName axis : machine.linear_axes()) add_motions(axis, symbols);
  return symbols;
}

std::vector<LocationSymbol> squareness_errors(const Machine& machine) {
  std::vector<LocationSymbol> symbols;
  for (const LocationSymbol& symbol : machine.datum.squareness()) {
    if (machine.has_axis(symbol.axis)) symbols.push_back(symbol);
  }
  for (const AxisName axis : machine.parallel_axes()) {
    for (const Component about : {Component::A, Component::B, Component::C}) {
      if (direction_of(about) != direction_of(axis)) symbols.push_back({about, axis});
    }
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

bool turns_fully(const Axis& axis) { return is_rotary(axis.name) && axis.travel() > kNearlyAFullTurn; }

FunctionSpec usual_function(const Axis& axis) {
  FunctionSpec function;
  if (!turns_fully(axis)) return function;
  function.basis = "fourier";
  function.automatic_degree = true;
  return function;
}

std::vector<AxisName> moving_rotary_axes(const Campaign& campaign) {
  std::vector<AxisName> moving;
  for (const Axis& axis : campaign.machine.axes) {
    if (is_rotary(axis.name) && moves(measured_ends_of(campaign, axis.name), axis))
      moving.push_back(axis.name);
  }
  return moving;
}

std::map<AxisName, double> standing_rotary_axes(const Campaign& campaign) {
  std::map<AxisName, double> standing;
  for (const Axis& axis : campaign.machine.axes) {
    if (!is_rotary(axis.name)) continue;
    const std::pair<double, double> ends = measured_ends_of(campaign, axis.name);
    if (ends.first <= ends.second && !moves(ends, axis))
      standing[axis.name] = 0.5 * (ends.first + ends.second);
  }
  return standing;
}

std::vector<AxisName> rotary_axes_without_errors(const Campaign& campaign, const ModelSpec& model) {
  std::vector<AxisName> axes = moving_rotary_axes(campaign);
  std::erase_if(axes, [&](AxisName axis) {
    const auto of_axis = [&](const auto& entry) { return entry.first.axis == axis; };
    return std::ranges::any_of(model.functions, of_axis) || std::ranges::any_of(model.locations, of_axis);
  });
  return axes;
}

std::vector<ErrorSymbol> motions_in_campaign(const Campaign& campaign) {
  std::vector<ErrorSymbol> symbols = linear_axis_motions(campaign.machine);
  for (const AxisName axis : moving_rotary_axes(campaign)) add_motions(axis, symbols);
  return symbols;
}

ModelSpec with_rotary_errors(const Machine& machine, ModelSpec model, const std::vector<AxisName>& moving,
                             const std::vector<LocationSymbol>& locations) {
  if (model.default_function.basis == "zero") return model;
  for (const AxisName axis : moving) {
    for (const Component component : kAllComponents)
      model.functions.try_emplace({component, axis}, usual_function(machine.axis(axis)));
  }
  for (const LocationSymbol& symbol : locations) {
    const bool is_moving = std::ranges::find(moving, symbol.axis) != moving.end();
    const bool is_off = std::ranges::find(model.locations_off, symbol) != model.locations_off.end();
    if (is_moving && !is_off) model.locations.try_emplace(symbol, 0.0);
  }
  return model;
}

ModelSpec with_uncertain_values_open(const Campaign& campaign, ModelSpec model) {
  for (const Setup& setup : campaign.setups) {
    const Tool& tool = campaign.machine.tools[setup.tool];
    if (tool.offset_sigma > 0.0) model.tool_errors.erase(tool.name);
  }
  for (const Axis& axis : campaign.machine.axes) {
    if (axis.expansion && axis.expansion->per_kelvin_sigma > 0.0) model.expansions.erase(axis.name);
  }
  return model;
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
