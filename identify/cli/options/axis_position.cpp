#include "volcal/identify/cli/options/axis_position.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <set>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal::cli {
namespace {

std::string axis_names(const Machine& machine) {
  std::string names;
  for (const Axis& axis : machine.axes)
    names += (names.empty() ? "" : " ") + std::string(1, letter_of(axis.name));
  return names;
}

}  // namespace

AxisPosition axis_position(const std::string& option, const std::string& text, const Machine& machine) {
  const auto error = [&](const std::string& problem, const std::string& remedy) {
    return InputError({}, option + " " + text + ": " + problem, remedy);
  };
  AxisPosition position{};
  for (const Axis& axis : machine.axes) position[index_of(axis.name)] = axis.home;
  std::set<AxisName> named;
  for (const std::string& part : CLI::detail::split(text, ',')) {
    const std::string usage = "write axes and positions in mm or deg, as in X=100,Y=-20.5";
    if (part.size() < 3 || part[1] != '=')
      throw error("\"" + part + "\" is not a position of an axis", usage);
    const auto name = axis_from_letter(part[0]);
    if (!name || !machine.has_axis(*name)) {
      throw error(fmt::format("the machine has no axis {}", part[0]), "its axes are " + axis_names(machine));
    }
    if (!named.insert(*name).second)
      throw error(fmt::format("{} is given twice", part[0]), "leave one of the two out");
    double value = 0.0;
    if (!CLI::detail::lexical_cast(part.substr(2), value) || !std::isfinite(value))
      throw error("\"" + part.substr(2) + "\" is not a number", usage);
    const double unit = position_unit(*name).si_per_unit;
    const Axis& axis = machine.axis(*name);
    constexpr double kRounding = 1e-9;
    if (value * unit < axis.travel_min - kRounding || value * unit > axis.travel_max + kRounding) {
      throw error(fmt::format("{} lies outside the travel of {}", part.substr(2), part[0]),
                  fmt::format("give {:g} to {:g}", axis.travel_min / unit, axis.travel_max / unit));
    }
    position[index_of(*name)] = value * unit;
  }
  return position;
}

ApproachDirection approach_direction(const std::string& option, const std::string& text,
                                     const Machine& machine) {
  ApproachDirection direction{};
  for (std::size_t i = 0; i < text.size(); i += 3) {
    const auto axis = axis_from_letter(text[i]);
    const bool complete = i + 1 < text.size() && (text[i + 1] == '+' || text[i + 1] == '-') &&
                          (i + 2 == text.size() || text[i + 2] == ',');
    if (!axis || !machine.has_axis(*axis) || !complete)
      throw InputError({}, option + " " + text + " names no direction of the machine's axes",
                       "write the axes and the direction they move in, as X+,Y-");
    if (direction[index_of(*axis)] != 0)
      throw InputError({}, fmt::format("{} {} names {} twice", option, text, letter_of(*axis)),
                       "give one direction for each axis");
    direction[index_of(*axis)] = text[i + 1] == '+' ? 1 : -1;
  }
  return direction;
}

}  // namespace volcal::cli
