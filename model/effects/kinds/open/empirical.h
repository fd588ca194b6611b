#pragma once
/// Surfaces: smooth functions of recorded variables that the readings alone draw.

#include <string>

#include "volcal/model/effects/effect.h"

namespace volcal {

const EffectKind& empirical_effect();

bool is_surface(const EffectSpec& spec);
bool is_surface(const EffectName& name);
/// Of one to three variables as a model file names them: surface_spec("EAY", "y T_column").
EffectSpec surface_spec(const std::string& target, const std::string& drivers);

}  // namespace volcal
