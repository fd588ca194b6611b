#include "volcal/identify/report/text/compensation_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "volcal/identify/report/text/text_tables.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

const std::string kExpectedOnMachine = "expected on the machine";
constexpr double kShownResolution = 1e-10;  // m; finer ones limit nothing

std::vector<std::string> left_figures(const std::string& name, const ErrorLeft& left) {
  return {name, fixed_number(left.rms / kMicro, 2), fixed_number(left.max / kMicro, 2)};
}

std::vector<std::string> letters_of(const FixedLeft& fixed) {
  std::vector<std::string> letters;
  for (const AxisName axis : fixed.axes) letters.emplace_back(1, letter_of(axis));
  return letters;
}

std::string fixed_left_text(const FixedLeft& fixed) {
  return fmt::format("no axis moves along {}: {} um RMS of it, {} um max stay whatever the tables\n",
                     fixed.axes_text(), fixed_number(fixed.error.rms / kMicro, 2),
                     fixed_number(fixed.error.max / kMicro, 2));
}

nlohmann::ordered_json left_json(const ErrorLeft& left) {
  return {{"rms_um", left.rms / kMicro}, {"max_um", left.max / kMicro}};
}

std::string settings_text(const TableFormat& format) {
  std::string text;
  for (const TableSetting& setting : format.settings) {
    text += fmt::format("    --set {}: {}{}\n", setting.name, setting.help,
                        setting.otherwise.empty() ? std::string(", must be given")
                                                  : fmt::format("; otherwise {}", setting.otherwise));
  }
  return text;
}

/// ", W at -50 mm", or nothing where the machine has no parallel axis.
std::string at_home_text(const std::optional<ParallelLeft>& over) {
  std::string text;
  for (const Axis& axis : over ? over->axes : std::vector<Axis>{})
    text += fmt::format(", {} at {:g} mm", letter_of(axis.name), axis.home / kMetrePerMillimetre);
  return text;
}

/// "W from -400 to 50 mm".
std::string over_travel_text(const ParallelLeft& over) {
  std::vector<std::string> axes;
  for (const Axis& axis : over.axes)
    axes.push_back(fmt::format("{} from {:g} to {:g} mm", letter_of(axis.name),
                               axis.travel_min / kMetrePerMillimetre, axis.travel_max / kMetrePerMillimetre));
  return fmt::format("{}", fmt::join(axes, ", "));
}

nlohmann::ordered_json over_parallel_json(const ParallelLeft& over) {
  nlohmann::ordered_json json;
  for (const Axis& axis : over.axes) {
    json["travel_mm"][std::string(1, letter_of(axis.name))] = {axis.travel_min / kMetrePerMillimetre,
                                                               axis.travel_max / kMetrePerMillimetre};
  }
  json["before"] = left_json(over.before);
  json["tables"] = left_json(over.exported);
  return json;
}

nlohmann::ordered_json homes_json(const ParallelLeft& over) {
  nlohmann::ordered_json json;
  for (const Axis& axis : over.axes)
    json[std::string(1, letter_of(axis.name))] = axis.home / kMetrePerMillimetre;
  return json;
}

}  // namespace

std::string volume_check_text(const VolumeCheck& check, const CompensationType& type) {
  TextTable volume({{"", Align::Left}, {"RMS [um]"}, {"max [um]"}},
                   "Error left in the volume" + at_home_text(check.over_parallel));
  volume.add_row(left_figures("before", check.before));
  const std::string of_linear_axes = type.linear().name();
  volume.add_row(left_figures(of_linear_axes.empty() ? "ideal" : "ideal " + of_linear_axes, check.ideal));
  volume.add_row(left_figures("tables read back", check.exported));
  if (check.identification_u > 0.0)
    volume.add_row({kExpectedOnMachine, fixed_number(check.expected_rms() / kMicro, 2), ""});
  if (check.over_conditions)
    volume.add_row(left_figures("tables, ends of the campaign's conditions", *check.over_conditions));
  if (check.over_parallel) {
    const std::string travel = over_travel_text(*check.over_parallel);
    volume.add_row(left_figures("before, " + travel, check.over_parallel->before));
    volume.add_row(left_figures("tables, " + travel, check.over_parallel->exported));
  }
  TextTable parts({{"of it", Align::Left}, {"RMS before [um]"}, {"RMS after [um]"}, {"max after [um]"}});
  for (const PartLeft& part : check.parts) {
    parts.add_row({CompensationType(part.part).name(), fixed_number(part.before.rms / kMicro, 2),
                   fixed_number(part.exported.rms / kMicro, 2), fixed_number(part.exported.max / kMicro, 2)});
  }
  return volume.text() + (check.fixed ? fixed_left_text(*check.fixed) : "") + parts.text();
}

nlohmann::ordered_json volume_check_json(const VolumeCheck& check) {
  nlohmann::ordered_json json = {{"before", left_json(check.before)},
                                 {"ideal", left_json(check.ideal)},
                                 {"tables", left_json(check.exported)},
                                 {"identification_u_um", check.identification_u / kMicro},
                                 {"expected_rms_um", check.expected_rms() / kMicro}};
  if (check.fixed) {
    json["no_axis_moves_along"] = left_json(check.fixed->error);
    json["no_axis_moves_along"]["axes"] = letters_of(*check.fixed);
  }
  if (check.over_conditions) json["tables_over_conditions"] = left_json(*check.over_conditions);
  if (check.over_parallel) {
    json["parallel_axes_at_mm"] = homes_json(*check.over_parallel);
    json["over_parallel_axes"] = over_parallel_json(*check.over_parallel);
  }
  for (const PartLeft& part : check.parts) {
    json["by_type"][CompensationType(part.part).name()] = {{"before", left_json(part.before)},
                                                           {"tables", left_json(part.exported)}};
  }
  return json;
}

std::string rotary_check_text(const RotaryCheck& check, const CompensationType& type) {
  TextTable table({{"", Align::Left}, {"RMS [um]"}, {"max [um]"}, {"tool axis [urad]"}},
                  fmt::format("Errors of rotary axes left at {} poses of all axes", kRotaryCheckPoses));
  const auto add = [&table](const std::string& name, const RotaryLeft& left) {
    table.add_row({name, fixed_number(left.rms / kMicro, 2), fixed_number(left.max / kMicro, 2),
                   fixed_number(left.axis_rms / kMicro, 2)});
  };
  add("before", check.before);
  add("ideal " + type.rotary().name(), check.ideal);
  add("tables read back", check.exported);
  if (check.identification_u > 0.0)
    table.add_row({kExpectedOnMachine, fixed_number(check.expected_rms() / kMicro, 2), "", ""});
  return table.text();
}

namespace {

std::vector<std::string> pose_figures(const std::string& name, const PoseErrorLeft& left) {
  std::vector<std::string> row = left_figures(name, left);
  row.push_back(fixed_number(left.axis_rms / kMicro, 2));
  row.push_back(fixed_number(left.axis_max / kMicro, 2));
  return row;
}

nlohmann::ordered_json pose_json(const PoseErrorLeft& left) {
  nlohmann::ordered_json json = left_json(left);
  json["tool_axis_urad"] = left.axis_rms / kMicro;
  json["tool_axis_max_urad"] = left.axis_max / kMicro;
  return json;
}

}  // namespace

std::string all_axes_text(const AllAxesCheck& check) {
  TextTable table(
      {{"", Align::Left}, {"RMS [um]"}, {"max [um]"}, {"tool axis RMS [urad]"}, {"max [urad]"}},
      fmt::format(
          "Errors of all axes left at {} poses of all axes, without the best rigid motion of the workpiece",
          kAllAxesPoses));
  table.add_row(pose_figures("before", check.before));
  table.add_row(pose_figures("tables read back", check.exported));
  if (check.identification_u > 0.0)
    table.add_row({kExpectedOnMachine, fixed_number(check.expected_rms() / kMicro, 2), "", "", ""});
  return table.text();
}

nlohmann::ordered_json all_axes_json(const AllAxesCheck& check) {
  return {{"before", pose_json(check.before)},
          {"tables", pose_json(check.exported)},
          {"levers_of_tilted_head", pose_json(check.levers)},
          {"identification_u_um", check.identification_u / kMicro},
          {"expected_rms_um", check.expected_rms() / kMicro}};
}

nlohmann::ordered_json rotary_check_json(const RotaryCheck& check) {
  nlohmann::ordered_json json;
  for (const auto& [name, left] : {std::pair{"before", &check.before}, std::pair{"ideal", &check.ideal},
                                   std::pair{"tables", &check.exported}})
    json[name] = {{"rms_um", left->rms / kMicro},
                  {"max_um", left->max / kMicro},
                  {"tool_axis_urad", left->axis_rms / kMicro}};
  json["identification_u_um"] = check.identification_u / kMicro;
  json["expected_rms_um"] = check.expected_rms() / kMicro;
  return json;
}

std::string limits_text(const CompensationLimits& limits) {
  std::string text;
  if (limits.points_per_table > 0)
    text += fmt::format("at most {} positions a table, ", limits.points_per_table);
  if (limits.resolution >= kShownResolution)
    text += fmt::format("values in steps of {} um, ", short_number(limits.resolution / kMicro));
  if (limits.equidistant) text += "equal steps, ";
  return text + (limits.both_directions ? "both directions" : "one table for both directions");
}

std::string table_formats_text() {
  std::string text;
  for (const TableFormat* format : table_formats()) {
    text += fmt::format(
        "{}\n    {}\n    types: {}; others: {}\n    limits: {}\n{}    source: {}\n    verified: {}\n",
        format->name, format->summary, (format->supported | format->rotary).name(), format->refusal,
        limits_text(format->limits), settings_text(*format), format->source, format->verified);
  }
  text += "\nNot written\n";
  for (const RefusedFormat& refused : refused_table_formats())
    text += fmt::format("    {}: {}\n", refused.name, refused.reason);
  text += "\nTypes of compensation (ISO/TR 16907:2015), joined by +\n";
  for (const CompensationTypeInfo& info : compensation_types())
    text += fmt::format("    {} ({}): {}; from {}\n", info.name, info.clause, info.summary, info.errors);
  return text;
}

nlohmann::ordered_json table_formats_json() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const TableFormat* format : table_formats()) {
    nlohmann::ordered_json settings = nlohmann::ordered_json::array();
    for (const TableSetting& setting : format->settings)
      settings.push_back({{"name", setting.name}, {"help", setting.help}, {"otherwise", setting.otherwise}});
    list.push_back({{"name", format->name},
                    {"summary", format->summary},
                    {"types", (format->supported | format->rotary).name()},
                    {"refusal", format->refusal},
                    {"points_per_table", format->limits.points_per_table},
                    {"resolution_um", format->limits.resolution / kMicro},
                    {"both_directions", format->limits.both_directions},
                    {"equidistant", format->limits.equidistant},
                    {"settings", settings},
                    {"source", format->source},
                    {"verified", format->verified}});
  }
  nlohmann::ordered_json not_written = nlohmann::ordered_json::array();
  for (const RefusedFormat& refused : refused_table_formats())
    not_written.push_back({{"name", refused.name}, {"reason", refused.reason}});
  return {{"formats", list}, {"not_written", not_written}};
}

}  // namespace volcal
