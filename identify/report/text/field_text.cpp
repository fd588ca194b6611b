#include "volcal/identify/report/text/field_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/errors.h"

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

void require_measured_travel(const FitResult& result) {
  const std::vector<Finding> unmeasured = unmeasured_travel(result);
  if (unmeasured.empty()) return;
  throw InputError({}, "--no-extrapolation: " + sentence(unmeasured.front()),
                   "measure the whole travel, set travel_mm to what was measured, or leave the option out");
}

}  // namespace volcal
