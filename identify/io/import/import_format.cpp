#include "volcal/identify/io/import/import_format.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

#include "volcal/identify/io/import/table_layout.h"
#include "volcal/identify/text/nearest_name.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

using NamedUnit = std::pair<std::string_view, double>;

constexpr double kRadianPerGon = std::numbers::pi / 200.0;
constexpr double kRadianPerArcsecond = kRadianPerDegree / 3600.0;

constexpr auto kLengthUnits = std::to_array<NamedUnit>({{"mm", kMetrePerMillimetre},
                                                        {"um", kMetrePerMicrometre},
                                                        {"\u00B5m", kMetrePerMicrometre},
                                                        {"\u03BCm", kMetrePerMicrometre},
                                                        {"nm", 1e-9},
                                                        {"m", 1.0},
                                                        {"inch", kMetrePerInch},
                                                        {"in", kMetrePerInch}});
constexpr auto kAngleUnits = std::to_array<NamedUnit>({{"deg", kRadianPerDegree},
                                                       {"\u00B0", kRadianPerDegree},
                                                       {"gon", kRadianPerGon},
                                                       {"rad", 1.0},
                                                       {"mrad", kRadianPerMilliradian},
                                                       {"urad", kRadianPerMicroradian},
                                                       {"\u00B5rad", kRadianPerMicroradian},
                                                       {"um/m", kRadianPerMicroradian},
                                                       {"arcsec", kRadianPerArcsecond}});

std::optional<double> unit_in(std::span<const NamedUnit> units, std::string_view name) {
  const auto found = std::ranges::find(units, name, &NamedUnit::first);
  return found == units.end() ? std::nullopt : std::optional(found->second);
}

std::string first_line(const std::string& text) {
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  return start == std::string::npos ? "" : text.substr(start, text.find_first_of("\r\n", start) - start);
}

std::vector<std::string> names_of_formats() {
  std::vector<std::string> names;
  for (const ImportFormat* format : import_formats()) names.emplace_back(format->name());
  return names;
}

void require_axes_of_machine(const ImportAnswers& answers, const Machine& machine) {
  for (const auto& [axis, position] : answers.at) {
    if (!machine.has_axis(axis))
      throw InputError({}, std::string("--at names ") + letter_of(axis) + ", which the machine does not have",
                       "its axes are those of the structure \"" + machine.structure.code + "\"");
  }
}

}  // namespace

const ImportFormat& generic_csv_format();

const ImportFormat& import_format_of(const ImportSource& source, const std::optional<std::string>& name) {
  for (const ImportFormat* format : import_formats()) {
    if (name ? format->name() == *name : format->recognises(source)) return *format;
  }
  const auto names = names_of_formats();
  if (name)
    throw InputError({}, "format " + printable(*name) + " is not known",
                     suggest_name(*name, names, "formats"));
  if (resembles_table(source)) return generic_csv_format();
  throw InputError({source.path, 1},
                   "the file is not understood; it begins \"" + printable(first_line(source.text)) + "\"",
                   "files of these formats are read: " + join_names(names) +
                       "; name one with --format to learn which line is wrong");
}

void ask_for(const ImportSource& source, const std::string& what, const std::string& option) {
  throw InputError({source.path, 0}, "the file does not say " + what, "give " + option);
}

void require_choice(const std::string& option, const std::string& value,
                    const std::vector<std::string>& choices) {
  if (std::ranges::find(choices, value) != choices.end()) return;
  throw InputError({}, option + " is \"" + printable(value) + "\"", suggest_name(value, choices, "values"));
}

bool varies(const std::vector<double>& positions) {
  return std::ranges::adjacent_find(positions, std::ranges::not_equal_to()) != positions.end();
}

double shift_of(AxisName axis, const std::vector<double>& positions, const SourcePlace& place,
                const ImportAnswers& answers) {
  const auto shift = answers.at.find(axis);
  if (shift == answers.at.end()) return 0.0;
  if (!varies(positions))
    throw InputError(place,
                     std::string("the table says where ") + letter_of(axis) + " stood, and so does --at",
                     "leave one of the two out; --at is added to the positions of an axis that moves");
  return shift->second;
}

std::string shift_text(AxisName axis, double shift) {
  return number_text(shift) + " " + std::string(position_unit(axis).suffix) + " added to its positions";
}

void add_standing_axes(const ImportSource& source, const ImportAnswers& answers, const Machine& machine,
                       const std::vector<AxisName>& moving, ImportedReadings& readings) {
  const auto moves = [&](AxisName axis) { return std::ranges::find(moving, axis) != moving.end(); };
  std::string missing;
  require_axes_of_machine(answers, machine);
  for (const Axis& axis : machine.axes) {
    if (moves(axis.name)) continue;
    const auto stated = answers.at.find(axis.name);
    if (stated == answers.at.end()) {
      missing += (missing.empty() ? "" : ",") + std::string(1, letter_of(axis.name)) + "=...";
      continue;
    }
    readings.columns.push_back(
        {position_column(axis.name), std::vector<double>(readings.source_line.size(), stated->second)});
    readings.facts.push_back(
        {std::string(1, letter_of(axis.name)),
         number_text(stated->second) + " " + std::string(position_unit(axis.name).suffix), "--at"});
  }
  if (!missing.empty())
    ask_for(source, "where the other axes stood", "--at " + missing + " (machine coordinates, mm or deg)");
}

std::optional<double> length_unit(std::string_view name) { return unit_in(kLengthUnits, name); }
std::optional<double> angle_unit(std::string_view name) { return unit_in(kAngleUnits, name); }

}  // namespace volcal
