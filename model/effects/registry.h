#pragma once
/// The registered effects: the library's own, and those that a program adds.

#include <memory>
#include <span>
#include <string_view>

#include "volcal/model/effects/effect.h"

namespace volcal {

std::span<const EffectKind* const> effect_kinds();
const EffectKind* find_effect(std::string_view kind);

/// Largest |amplitude| that a model file takes, SI, by the schema of the effect's kind; 1e5 of its unit, as
/// of error motions, where no kind has it: errors that a model leaves out.
double largest_amplitude(const Effect& effect, const EffectAmplitude& amplitude);

/// Adds a kind of effect of the program's own, which model files, fits and diagnoses then know like those of
/// the library; before the library is used. Throws std::invalid_argument when its name is empty or taken.
const EffectKind& register_effect(std::unique_ptr<const EffectKind> kind);

}  // namespace volcal
