#include "volcal/model/effects/conditions_of_effect.h"

namespace volcal {

std::set<Variable> conditions_of_effect(const EffectSpec& spec, const Effect& effect) {
  std::set<Variable> conditions;
  const auto channel = spec.options.text("temperature");
  if (channel) conditions.insert(temperature_of(*channel));
  for (const std::string& word : words_in(effect.name().driver)) {
    const auto variable = Variable::parse_written(word);
    if (!variable || !variable->changes_at_rest()) continue;
    const bool is_named = channel && variable->kind == Variable::Kind::Temperature;
    if (!is_named) conditions.insert(*variable);
  }
  return conditions;
}

}  // namespace volcal
