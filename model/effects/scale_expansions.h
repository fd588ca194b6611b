#pragma once
/// By which temperatures a model expands the scales of a machine.

#include <set>
#include <string>

#include "volcal/model/description/machine.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/effects/effect.h"

namespace volcal {

/// Temperature channels by which an effect expands scales (EffectSchema::expands_scales).
std::set<std::string> expansion_channels(const Effect& effect);
/// Those by which the machine file or an effect of the model expands the scale of an axis.
std::set<std::string> expansion_channels(const Machine& machine, const ModelSpec& model);

}  // namespace volcal
