#pragma once
/// Laws that a user asks a diagnosis for: which target follows which of one to three recorded variables.

#include <string>
#include <vector>

#include "volcal/model/description/model_spec.h"

namespace volcal {

/// "TARGET: DRIVERS", in the place of the surface of these variables where the model has it; "model": all
/// surfaces of the model. They are taken out of the model, so that laws are looked for in their place and not
/// beside them. Throws InputError.
std::vector<EffectSpec> asked_laws(const std::string& text, ModelSpec& model);

}  // namespace volcal
