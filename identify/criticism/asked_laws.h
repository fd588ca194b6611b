#pragma once
/// Laws that a user asks a diagnosis for: which target follows which of one to three recorded variables.

#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/model/description/finding.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

/// "TARGET: DRIVERS", in the place of the surface of these variables where the model has it; "model": all
/// surfaces of the model. They are taken out of the model, so that laws are looked for in their place and not
/// beside them. Throws InputError.
std::vector<EffectSpec> asked_laws(const std::string& text, ModelSpec& model);

/// "diagnosis.without-surfaces": the surfaces of `given` that asked_laws() took out of `criticised`; nothing
/// where none was.
std::optional<Finding> surfaces_taken_out(const ModelSpec& given, const ModelSpec& criticised);

/// Takes out of a model the surfaces that its diagnosis was made without: beside what the diagnosis found in
/// their place they would be in it twice. Their labels; nothing where the model has none of them.
std::vector<std::string> take_out_surfaces(const Diagnosis& diagnosis, ModelSpec& model);

}  // namespace volcal
