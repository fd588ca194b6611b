#include "volcal/identify/errors/acting_conditions.h"

#include <algorithm>
#include <limits>
#include <string>

#include "volcal/identify/errors/machine_effects.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

void add_conditions(const EffectReach& reach, std::set<Variable>& acting) {
  for (const std::string& channel : reach.temperature) acting.insert(temperature_of(channel));
  if (reach.time) acting.insert({Variable::Kind::Time});
  if (reach.feed) acting.insert({Variable::Kind::Feed});
}

/// Of the effects of any tool, or of its curves and surfaces alone.
std::set<Variable> conditions_of_effects(const FitResult& result, const Conditions& conditions,
                                         bool surfaces_alone) {
  std::set<Variable> acting;
  for (const Tool& tool : result.machine.functional_tools()) {
    const MachineEffects effects(result, tool, conditions);
    for (std::size_t e = 0; e < effects.effect_count(); ++e) {
      if (!surfaces_alone || effects.is_surface(e)) add_conditions(effects.reach(e), acting);
    }
  }
  return acting;
}

FindingNumber number_of_variable(const Variable& variable, double si) {
  const Unit unit = variable.unit();
  return {si, unit_text(unit.suffix), unit.si_per_unit};
}

/// Of a condition that the user stated and no pose depends on.
Finding stated_in_vain(const FitResult& result, const StatedCondition& condition,
                       const std::optional<RecordedRange>& range) {
  const Variable& variable = condition.variable;
  if (range && range->origin == ConditionOrigin::Tables)
    return {FindingCode::TablesOfOtherConditions,
            {{"condition", variable.name()},
             {"value", number_of_variable(variable, condition.value * variable.unit().si_per_unit)},
             {"of_tables", number_of_variable(variable, range->mean)}}};
  std::vector<std::string> on_paths;
  for (const EffectOnNoPose& effect : effects_on_no_pose(result)) {
    if (effect.conditions.contains(variable)) on_paths.push_back(effect.label);
  }
  if (on_paths.empty()) return {FindingCode::ConditionWithoutEffect, {{"condition", variable.name()}}};
  return {FindingCode::ConditionOnPathsAlone, {{"condition", variable.name()}, {"effects", on_paths}}};
}

std::optional<RecordedRange> recorded_range(const FitResult& result, const Variable& variable) {
  if (variable.kind == Variable::Kind::Time) return result.conditions.time;
  if (variable.kind == Variable::Kind::Feed) return result.conditions.feed;
  const auto found = result.conditions.temperature_degC.find(variable.subject);
  return found == result.conditions.temperature_degC.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace

std::set<Variable> conditions_that_act(const FitResult& result, const Conditions& conditions) {
  std::set<Variable> acting = conditions_of_effects(result, conditions, false);
  for (const Axis& axis : result.machine.axes) {
    if (axis.expansion) acting.insert(temperature_of(axis.expansion->channel));
  }
  return acting;
}

std::vector<Finding> conditions_beyond_readings(const FitResult& result, const Conditions& conditions) {
  const std::set<Variable> acting = conditions_that_act(result, conditions);
  const std::set<Variable> of_surfaces = conditions_of_effects(result, conditions, true);
  std::vector<Finding> findings;
  Conditions by_value = conditions;  // whoever names the reference temperature means the same
  by_value.stated.clear();
  for (const StatedCondition& condition : list_conditions(result, by_value)) {
    const bool matters = condition.origin == kAsStated ? acting.contains(condition.variable)
                                                       : of_surfaces.contains(condition.variable);
    const std::optional<RecordedRange> range = recorded_range(result, condition.variable);
    if (!matters || !range || !(range->min < range->max)) continue;
    const auto number = [&condition](double si) { return number_of_variable(condition.variable, si); };
    const double value = condition.value * condition.variable.unit().si_per_unit;
    if (value >= range->min && value <= range->max) continue;
    findings.push_back({FindingCode::ConditionBeyondReadings,
                        {{"condition", condition.variable.name()},
                         {"value", number(value)},
                         {"measured_from", number(range->min)},
                         {"measured_to", number(range->max)}}});
  }
  return findings;
}

std::vector<Finding> conditions_in_vain(const FitResult& result, const Conditions& conditions) {
  const std::set<Variable> acting = conditions_that_act(result, conditions);
  std::vector<Finding> findings;
  for (const StatedCondition& condition : list_conditions(result, conditions)) {
    if (condition.origin == kAsStated && !acting.contains(condition.variable))
      findings.push_back(stated_in_vain(result, condition, recorded_range(result, condition.variable)));
  }
  return findings;
}

std::vector<StatedCondition> acting_conditions(const FitResult& result, const Conditions& conditions) {
  std::vector<StatedCondition> list = list_conditions(result, conditions);
  std::erase_if(list, [acting = conditions_that_act(result, conditions)](const StatedCondition& condition) {
    return condition.origin != kAsStated && !acting.contains(condition.variable);
  });
  return list;
}

double shortest_wave(const FitResult& result, AxisName axis) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const EffectSpec& spec : result.identified.effects) {
    const auto effect = find_effect(spec.kind)->make(spec, result.identified.file);
    if (!effect->name().driver.is(position_of(axis))) continue;
    for (const EffectShape& shape : effect->shapes()) {
      if (shape.key != "period_mm") continue;
      const ParameterBlock* block = result.layout.find_block(shape.label);
      shortest = std::min(shortest, block != nullptr ? result.parameters[block->offset] : shape.value);
    }
  }
  return shortest;
}

}  // namespace volcal
