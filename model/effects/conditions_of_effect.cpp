#include "volcal/model/effects/conditions_of_effect.h"

namespace volcal {

std::set<Variable> conditions_of_effect(const EffectSpec& spec, const Effect& effect) {
  std::set<Variable> conditions;
  const auto channel = spec.options.text("temperature");
  if (channel) conditions.insert(temperature_of(*channel));
  const bool is_written = effect.changes_with_any_driver() || effect.surface() != nullptr;
  for (const Variable& variable : effect.name().driver.variables()) {
    if (!variable.changes_at_rest()) continue;
    const bool is_named = channel && variable.kind == Variable::Kind::Temperature;
    const bool is_growth = variable.kind == Variable::Kind::Time && !is_written;
    if (!is_named && !is_growth) conditions.insert(variable);
  }
  return conditions;
}

}  // namespace volcal
