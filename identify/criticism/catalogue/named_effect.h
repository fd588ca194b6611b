#pragma once
/// Effects as a user names them.

#include <string>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

/// KIND:TARGET, or more of KIND:TARGET:DRIVER:SHAPE where that is not one effect. Throws InputError, naming
/// the option, when no effect or several effects that could act in the campaign are meant.
EffectSpec named_effect(const std::string& option, const std::string& text, const Campaign& campaign);

/// Several; throws InputError where one of them is named twice, too.
std::vector<EffectSpec> named_effects(const std::string& option, const std::vector<std::string>& texts,
                                      const Campaign& campaign);

}  // namespace volcal
