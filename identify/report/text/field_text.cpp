#include "volcal/identify/report/text/field_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "volcal/identify/errors/acting_conditions.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/variable.h"

namespace volcal {

std::string conditions_text(const FitResult& result, const Conditions& conditions) {
  const std::set<Variable> acting = conditions_that_act(result, conditions);
  std::string text, without_effect;
  for (const StatedCondition& condition : list_conditions(result, conditions)) {
    if (!acting.contains(condition.variable)) {
      if (condition.origin == kAsStated)
        without_effect +=
            "! no identified error depends on " + condition.variable.name() + ": it changes nothing\n";
      continue;
    }
    text += fmt::format("{}{} {:.6g} {} ({})", text.empty() ? "" : ", ", condition.variable.name(),
                        condition.value, unit_text(condition.variable.unit().suffix), condition.origin);
  }
  return (text.empty() ? text : "Stated for " + text + "\n") + without_effect +
         findings_text(conditions_beyond_readings(result, conditions));
}

nlohmann::ordered_json conditions_json(const FitResult& result, const Conditions& conditions) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  std::set<std::string> beyond;
  for (const Finding& finding : conditions_beyond_readings(result, conditions))
    beyond.insert(finding.text("condition"));
  for (const StatedCondition& condition : list_conditions(result, conditions)) {
    json[condition.name()] = {{"value", condition.value}, {"origin", condition.origin}};
    if (beyond.contains(condition.variable.name())) json[condition.name()]["beyond_readings"] = true;
  }
  return json;
}

void require_within_readings(const FitResult& result, const Conditions& conditions) {
  const std::vector<Finding> unmeasured = unmeasured_travel(result);
  if (!unmeasured.empty()) {
    throw InputError({}, "--no-extrapolation: " + sentence(unmeasured.front()),
                     "measure the whole travel, set travel_mm to what was measured, or leave the option out");
  }
  require_conditions_of_readings(result, conditions);
}

void require_conditions_of_readings(const FitResult& result, const Conditions& conditions) {
  const std::vector<Finding> beyond = conditions_beyond_readings(result, conditions);
  if (!beyond.empty()) {
    throw InputError({}, "--no-extrapolation: " + sentence(beyond.front()),
                     "measure under such conditions, state others by --conditions, or leave the option out");
  }
}

}  // namespace volcal
