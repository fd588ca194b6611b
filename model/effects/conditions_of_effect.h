#pragma once
/// What an effect depends on that changes at a pose.

#include <set>

#include "volcal/model/description/variable.h"
#include "volcal/model/effects/effect.h"

namespace volcal {

/// Temperatures and feeds: of the key `temperature`, or among its drivers; time where its law or surface is
/// written of it.
std::set<Variable> conditions_of_effect(const EffectSpec& spec, const Effect& effect);

}  // namespace volcal
