#include "volcal/identify/errors/acting_conditions.h"

#include "volcal/identify/errors/machine_effects.h"

namespace volcal {

std::set<Variable> conditions_that_act(const FitResult& result, const Conditions& conditions) {
  std::set<Variable> acting;
  for (const Axis& axis : result.machine.axes) {
    if (axis.expansion) acting.insert(temperature_of(axis.expansion->channel));
  }
  for (const Tool& tool : result.machine.tools) {
    const MachineEffects effects(result, tool, conditions);
    for (std::size_t e = 0; e < effects.effect_count(); ++e) {
      const EffectReach& reach = effects.reach(e);
      for (const std::string& channel : reach.temperature) acting.insert(temperature_of(channel));
      if (reach.time) acting.insert({Variable::Kind::Time});
      if (reach.feed) acting.insert({Variable::Kind::Feed});
    }
  }
  return acting;
}

std::vector<StatedCondition> acting_conditions(const FitResult& result, const Conditions& conditions) {
  std::vector<StatedCondition> list = list_conditions(result, conditions);
  std::erase_if(list, [acting = conditions_that_act(result, conditions)](const StatedCondition& condition) {
    return condition.origin != kAsStated && !acting.contains(condition.variable);
  });
  return list;
}

}  // namespace volcal
