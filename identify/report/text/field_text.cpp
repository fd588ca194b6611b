#include "volcal/identify/report/text/field_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/variable.h"

namespace volcal {
namespace {

/// Conditions that the errors of any tool depend on.
std::set<Variable> influences_on(const FitResult& result, const Conditions& conditions) {
  std::set<Variable> influences;
  for (const Axis& axis : result.machine.axes) {
    if (axis.expansion) influences.insert(temperature_of(axis.expansion->channel));
  }
  for (const Tool& tool : result.machine.tools) {
    const MachineEffects effects(result, tool, conditions);
    for (std::size_t e = 0; e < effects.effect_count(); ++e) {
      const EffectReach& reach = effects.reach(e);
      for (const std::string& channel : reach.temperature) influences.insert(temperature_of(channel));
      if (reach.time) influences.insert({Variable::Kind::Time});
      if (reach.feed) influences.insert({Variable::Kind::Feed});
    }
  }
  return influences;
}

}  // namespace

std::string conditions_text(const FitResult& result, const Conditions& conditions) {
  const std::set<Variable> influences = influences_on(result, conditions);
  std::string text, without_effect;
  for (const StatedCondition& condition : list_conditions(result, conditions)) {
    if (!influences.contains(condition.variable)) {
      if (condition.origin == kAsStated)
        without_effect +=
            "! no identified error depends on " + condition.variable.name() + ": it changes nothing\n";
      continue;
    }
    text += fmt::format("{}{} {:.6g} {} ({})", text.empty() ? "" : ", ", condition.variable.name(),
                        condition.value, unit_text(condition.variable.unit().suffix), condition.origin);
  }
  return (text.empty() ? text : "Stated for " + text + "\n") + without_effect;
}

nlohmann::ordered_json conditions_json(const FitResult& result, const Conditions& conditions) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const StatedCondition& condition : list_conditions(result, conditions))
    json[condition.name()] = {{"value", condition.value}, {"origin", condition.origin}};
  return json;
}

void require_measured_travel(const FitResult& result) {
  const std::vector<Finding> unmeasured = unmeasured_travel(result);
  if (unmeasured.empty()) return;
  throw InputError({}, "--no-extrapolation: " + sentence(unmeasured.front()),
                   "measure the whole travel, set travel_mm to what was measured, or leave the option out");
}

}  // namespace volcal
