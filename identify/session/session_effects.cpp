#include "volcal/identify/session/session_effects.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/model/effects/registry.h"

namespace volcal {

EffectName name_of(const EffectSpec& spec) { return find_effect(spec.kind)->make(spec, {})->name(); }

void be_untested(EffectFinding& effect) {
  effect.log10_p = effect.gain = effect.visible_fraction = std::numeric_limits<double>::quiet_NaN();
}

std::vector<EffectFinding> given_effects(const ModelSpec& model) {
  std::vector<EffectFinding> effects;
  for (const EffectSpec& spec : model.effects) {
    const auto effect = find_effect(spec.kind)->make(spec, {});
    EffectFinding& given = effects.emplace_back();
    given.name = effect->name();
    given.label = effect_label(*effect);
    given.spec = spec;
    be_untested(given);
  }
  return effects;
}

ModelSpec given_model_with(ModelSpec given, const Campaign& campaign, std::vector<EffectFinding> effects) {
  std::erase_if(given.effects, [&](const EffectSpec& spec) {
    const EffectName name = name_of(spec);
    return std::erase_if(effects, [&](const EffectFinding& effect) { return effect.name == name; }) == 0;
  });
  return extended_model(std::move(given), campaign, effects);
}

}  // namespace volcal
