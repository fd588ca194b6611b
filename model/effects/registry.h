#pragma once
/// The registered effects.

#include <span>
#include <string_view>

#include "volcal/model/effects/effect.h"

namespace volcal {

std::span<const EffectKind* const> effect_kinds();
const EffectKind* find_effect(std::string_view kind);

}  // namespace volcal
