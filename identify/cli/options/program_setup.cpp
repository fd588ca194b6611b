#include "volcal/identify/cli/options/program_setup.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal::cli {
namespace {

constexpr double kLargestLength_mm = 1e5;

double length_number(const std::string& option, const std::string& text) {
  double value = 0.0;
  if (!CLI::detail::lexical_cast(text, value) || !(std::abs(value) <= kLargestLength_mm))
    throw InputError({}, fmt::format("{}: \"{}\" is not a length in mm", option, text),
                     "write a number of mm");
  return value * kMetrePerMillimetre;
}

/// "X10,Y20,Z-300": all three axes, each once.
Eigen::Vector3d three_coordinates(const std::string& option, const std::string& text) {
  const std::string usage = "write all of X, Y and Z in mm, as in X10,Y20,Z-300";
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  std::array<bool, 3> given{};
  for (const std::string& part : CLI::detail::split(text, ',')) {
    const char letter = part.empty() ? ' ' : part[0];
    if (letter < 'X' || letter > 'Z')
      throw InputError({}, fmt::format("{}: \"{}\" is not a coordinate", option, part), usage);
    const auto axis = static_cast<std::size_t>(letter - 'X');
    if (given[axis]) throw InputError({}, fmt::format("{}: {} is given twice", option, letter), usage);
    given[axis] = true;
    const std::size_t number = part.size() > 1 && part[1] == '=' ? 2 : 1;
    point[static_cast<Eigen::Index>(axis)] = length_number(option, part.substr(number));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!given[axis])
      throw InputError({}, fmt::format("{}: {} is not given", option, kNcAxisLetters[axis]), usage);
  }
  return point;
}

/// NAME=VALUE.
std::pair<std::string, std::string> name_and_value(const std::string& option, const std::string& text,
                                                   const std::string& usage) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw InputError({}, option + " " + text, usage);
  return {text.substr(0, equals), text.substr(equals + 1)};
}

void add_work_offset(const std::string& text, NcSetup& setup) {
  const auto [name, value] =
      name_and_value("--work-offset", text, "write G54=X10,Y20,Z-300 in mm, machine coordinates");
  const auto index = work_offset_index(name);
  if (!index)
    throw InputError({}, "--work-offset " + name + " is not a work offset",
                     "there are G54 to G59, G59.1 to G59.3");
  if (setup.work_offsets[*index])
    throw InputError({}, "--work-offset " + name + " is given twice", "give it once");
  setup.work_offsets[*index] = three_coordinates("--work-offset " + name, value);
}

void add_tool_length(const std::string& text, NcSetup& setup) {
  const std::string usage = "write H1=150.2 in mm";
  const auto [name, value] = name_and_value("--tool-length", text, usage);
  int number = 0;
  if (name[0] != 'H' || !CLI::detail::lexical_cast(name.substr(1), number) || number < 0)
    throw InputError({}, "--tool-length " + name + " is not a tool", usage);
  if (!setup.tool_lengths.emplace(number, length_number("--tool-length " + name, value)).second)
    throw InputError({}, "--tool-length " + name + " is given twice", "give it once");
}

}  // namespace

NcSetup program_setup(const ProgramSetupArguments& arguments, const Machine& machine) {
  NcSetup setup = nc_setup(machine);
  for (const std::string& text : arguments.work_offsets) add_work_offset(text, setup);
  for (const std::string& text : arguments.tool_lengths) add_tool_length(text, setup);
  if (!arguments.start.empty()) setup.start = three_coordinates("--start", arguments.start);
  if (!arguments.units.empty())
    setup.length_unit = arguments.units == "inch" ? kMetrePerInch : kMetrePerMillimetre;
  if (!arguments.block_delete.empty()) setup.block_delete = arguments.block_delete == "on";
  return setup;
}

}  // namespace volcal::cli
