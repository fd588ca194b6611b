#pragma once
/// Effects of the model that a session began with, and of its models.

#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

EffectName name_of(const EffectSpec& spec);

/// No test was made of it when it came into the model.
void be_untested(EffectFinding& effect);

/// Those of a model, untested.
std::vector<EffectFinding> given_effects(const ModelSpec& model);

/// The given model with those of its effects that are listed, as they were given, and with the others.
ModelSpec given_model_with(ModelSpec given, const Campaign& campaign, std::vector<EffectFinding> effects);

}  // namespace volcal
