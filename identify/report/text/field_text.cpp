#include "volcal/identify/report/text/field_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

/// Names, without unit, of the conditions that the errors of any tool depend on.
std::set<std::string> names_of_influence(const FitResult& result, const Conditions& conditions) {
  std::set<std::string> names;
  for (const Axis& axis : result.machine.axes) {
    if (axis.expansion) names.insert("T_" + axis.expansion->channel);
  }
  for (const Tool& tool : result.machine.tools) {
    const MachineEffects effects(result, tool, conditions);
    for (std::size_t e = 0; e < effects.effect_count(); ++e) {
      const EffectReach& reach = effects.reach(e);
      for (const std::string& channel : reach.temperature) names.insert("T_" + channel);
      if (reach.time) names.insert("time");
      if (reach.feed) names.insert("feed");
    }
  }
  return names;
}

}  // namespace

std::string conditions_text(const FitResult& result, const Conditions& conditions) {
  const std::set<std::string> influences = names_of_influence(result, conditions);
  std::string text;
  for (const StatedCondition& condition : list_conditions(result, conditions)) {
    const auto unit = condition.name.find('_', condition.name.starts_with("T_") ? 2 : 0);
    const std::string name = condition.name.ends_with("_degC")
                                 ? condition.name.substr(0, condition.name.size() - 5)
                                 : condition.name.substr(0, unit);
    if (!influences.contains(name)) continue;
    const char* shown_unit = condition.name.ends_with("_degC") ? "degC"
                             : condition.name == "time_s"      ? "s"
                                                               : "mm/min";
    text += fmt::format("{}{} {:.6g} {} ({})", text.empty() ? "" : ", ", name, condition.value, shown_unit,
                        condition.origin);
  }
  return text.empty() ? text : "Stated for " + text + "\n";
}

nlohmann::ordered_json conditions_json(const FitResult& result, const Conditions& conditions) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const StatedCondition& condition : list_conditions(result, conditions))
    json[condition.name] = {{"value", condition.value}, {"origin", condition.origin}};
  return json;
}

std::vector<std::string> unmeasured_travel(const FitResult& result) {
  constexpr double kNoticed = 1e-6;  // m or rad
  const MeasuredTravel measured(result);
  std::vector<std::string> sentences;
  for (const Axis& axis : result.machine.axes) {
    const double first = measured.min[index_of(axis.name)], last = measured.max[index_of(axis.name)];
    if (!(first > axis.travel_min + kNoticed) && !(last < axis.travel_max - kNoticed)) continue;
    const auto [suffix, unit] = position_unit(axis.name);
    sentences.push_back(fmt::format(
        "{} was measured from {:g} to {:g} of {:g} to {:g} {}: beyond it the last measured error is held",
        letter_of(axis.name), first / unit, last / unit, axis.travel_min / unit, axis.travel_max / unit,
        suffix));
  }
  return sentences;
}

void require_measured_travel(const FitResult& result) {
  const std::vector<std::string> sentences = unmeasured_travel(result);
  if (sentences.empty()) return;
  throw InputError({}, "--no-extrapolation: " + sentences.front(),
                   "measure the whole travel, set travel_mm to what was measured, or leave the option out");
}

std::vector<std::string> errors_in_no_table(const FitResult& result) {
  std::vector<std::string> sentences;
  for (const std::string& label : effects_on_no_pose(result))
    sentences.push_back(label + " was identified and is in no table: it acts along a path or in one setup");
  std::string axes;
  const auto add = [&axes](AxisName axis) {
    if (is_rotary(axis) && axes.find(letter_of(axis)) == std::string::npos) axes += letter_of(axis);
  };
  for (const FunctionGroup& group : result.layout.groups) add(group.axis);
  for (const ParameterBlock& block : result.layout.blocks) {
    if (block.location) add(block.location->axis);
  }
  for (const char axis : axes)
    sentences.push_back(fmt::format(
        "errors of axis {} were identified and are in no table: tables are for linear axes with {} at 0",
        axis, axis));
  return sentences;
}

}  // namespace volcal
