#include "volcal/model/effects/scale_expansions.h"

#include "volcal/model/effects/registry.h"

namespace volcal {

std::set<std::string> expansion_channels(const Effect& effect) {
  std::set<std::string> channels;
  const EffectKind* kind = find_effect(effect.name().kind);
  if (kind == nullptr || !kind->schema().expands_scales) return channels;
  for (const Variable& variable : effect.name().driver.variables()) {
    if (variable.kind == Variable::Kind::Temperature) channels.insert(variable.subject);
  }
  return channels;
}

std::set<std::string> expansion_channels(const Machine& machine, const ModelSpec& model) {
  std::set<std::string> channels;
  for (const Axis& axis : machine.axes) {
    if (axis.expansion) channels.insert(axis.expansion->channel);
  }
  for (const EffectSpec& effect : model.effects) {
    const EffectKind* kind = find_effect(effect.kind);
    if (kind != nullptr && kind->schema().expands_scales)
      channels.merge(expansion_channels(*kind->make(effect, model.file)));
  }
  return channels;
}

}  // namespace volcal
