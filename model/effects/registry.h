#pragma once
/// The registered effects: the library's own, and those that a program adds.

#include <memory>
#include <span>
#include <string_view>

#include "volcal/model/effects/effect.h"

namespace volcal {

std::span<const EffectKind* const> effect_kinds();
const EffectKind* find_effect(std::string_view kind);

/// Adds a kind of effect of the program's own, which model files, fits and diagnoses then know like those of
/// the library; before the library is used. Throws std::invalid_argument when its name is empty or taken.
const EffectKind& register_effect(std::unique_ptr<const EffectKind> kind);

}  // namespace volcal
