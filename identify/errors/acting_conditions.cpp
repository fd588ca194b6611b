#include "volcal/identify/errors/acting_conditions.h"

#include "volcal/identify/errors/machine_effects.h"
#include "volcal/model/description/finding_codes.h"

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
  for (const Tool& tool : result.machine.tools) {
    const MachineEffects effects(result, tool, conditions);
    for (std::size_t e = 0; e < effects.effect_count(); ++e) {
      if (!surfaces_alone || effects.is_surface(e)) add_conditions(effects.reach(e), acting);
    }
  }
  return acting;
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
  for (const StatedCondition& condition : list_conditions(result, conditions)) {
    const bool matters = condition.origin == kAsStated ? acting.contains(condition.variable)
                                                       : of_surfaces.contains(condition.variable);
    const std::optional<RecordedRange> range = recorded_range(result, condition.variable);
    if (!matters || !range || !(range->min < range->max)) continue;
    const Unit unit = condition.variable.unit();
    const auto number = [&unit](double si) {
      return FindingNumber{si, unit_text(unit.suffix), unit.si_per_unit};
    };
    const double value = condition.value * unit.si_per_unit;
    if (value >= range->min && value <= range->max) continue;
    findings.push_back({FindingCode::ConditionBeyondReadings,
                        {{"condition", condition.variable.name()},
                         {"value", number(value)},
                         {"measured_from", number(range->min)},
                         {"measured_to", number(range->max)}}});
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

}  // namespace volcal
