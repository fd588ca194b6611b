#include "volcal/identify/report/text/field_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "volcal/identify/errors/acting_conditions.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/report/text/findings_text.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"

namespace volcal {

std::string stated_for_text(std::span<const StatedCondition> conditions) {
  std::string text;
  for (const StatedCondition& condition : conditions)
    text += fmt::format("{}{} {:.6g} {} ({})", text.empty() ? "Stated for " : ", ", condition.variable.name(),
                        condition.value, unit_text(condition.variable.unit().suffix), condition.origin);
  return text.empty() ? text : text + "\n";
}

std::string conditions_text(const FitResult& result, const Conditions& conditions) {
  std::vector<StatedCondition> stated = list_conditions(result, conditions);
  std::erase_if(stated, [acting = conditions_that_act(result, conditions)](const StatedCondition& condition) {
    return !acting.contains(condition.variable);
  });
  return stated_for_text(stated) + findings_text(conditions_in_vain(result, conditions)) +
         findings_text(conditions_beyond_readings(result, conditions));
}

nlohmann::ordered_json conditions_json(const FitResult& result, const Conditions& conditions) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const StatedCondition& condition : list_conditions(result, conditions))
    json[condition.name()] = {{"value", condition.value}, {"origin", condition.origin}};
  const auto named = [&](const Finding& finding) -> nlohmann::ordered_json& {
    return json[Variable::parse(finding.text("condition")).value().column()];
  };
  for (const Finding& finding : conditions_beyond_readings(result, conditions))
    named(finding)["beyond_readings"] = true;
  for (const Finding& finding : conditions_in_vain(result, conditions))
    named(finding)["changes_nothing"] = sentence(finding);
  return json;
}

void require_within_readings(const FitResult& result, const Conditions& conditions) {
  const std::vector<Finding> unmeasured = unmeasured_travel(result);
  if (!unmeasured.empty()) {
    const AxisName axis = axis_from_letter(unmeasured.front().text("axis").front()).value();
    throw InputError({}, "--no-extrapolation: " + sentence(unmeasured.front()),
                     fmt::format("measure the whole travel, set travel_{} of [axes.{}] to what was measured, "
                                 "or leave the option out",
                                 position_unit(axis).suffix, letter_of(axis)));
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

void require_measured(const std::string& at, const Machine& machine, const MeasuredTravel& measured,
                      const AxisPosition& position, const VolumetricError& error) {
  if (!error.extrapolated) return;
  std::string why = "a curve or surface of the model was drawn from readings elsewhere";
  for (const Axis& axis : machine.axes) {
    const double q = position[index_of(axis.name)];
    const MeasuredEnds& ends = measured[axis.name];
    if (!ends.is_beyond(q)) continue;
    const Unit unit = position_unit(axis.name);
    why = fmt::format("{} at {:.6g} {} lies beyond the readings, {:.6g} to {:.6g} {}", letter_of(axis.name),
                      q / unit.si_per_unit, unit.suffix, ends.first / unit.si_per_unit,
                      ends.last / unit.si_per_unit, unit.suffix);
    break;
  }
  throw InputError({}, "--no-extrapolation: " + at + ": " + why,
                   "name a point within the readings, or leave the option out");
}

}  // namespace volcal
