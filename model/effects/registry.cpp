#include "volcal/model/effects/registry.h"

#include <algorithm>
#include <array>

namespace volcal {

// One line per effect.
#define VOLCAL_EFFECTS(EFFECT) EFFECT(reversal_effect)

#define VOLCAL_DECLARE(name) const EffectKind& name();
#define VOLCAL_ADDRESS(name) &(name)(),
VOLCAL_EFFECTS(VOLCAL_DECLARE)

std::span<const EffectKind* const> effect_kinds() {
  static const auto kinds = std::to_array<const EffectKind*>({VOLCAL_EFFECTS(VOLCAL_ADDRESS)});
  return kinds;
}

const EffectKind* find_effect(std::string_view kind) {
  const auto kinds = effect_kinds();
  const auto found =
      std::ranges::find_if(kinds, [&](const EffectKind* each) { return each->schema().kind == kind; });
  return found == kinds.end() ? nullptr : *found;
}

}  // namespace volcal
