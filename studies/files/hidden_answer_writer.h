#pragma once
/// truth/hidden.json: the sealed answer of a simulated campaign.
///
///     format      "volcal-hidden-1"
///     effects     kind, group, formula, the keys of the study, amplitude, unit, per, rms_um,
///                 rms_within_setups_um: of its own effect on the noise-free readings, as it is and without
///                 each setup's mean (an angle counts with an arm of 1 m)
///     noise       of each setup, what its campaign file does not say
///     outliers    setup, row (1-based line of its file), channel (from 0), sign

#include <string>

#include "volcal/sim/study.h"

namespace volcal {

std::string hidden_answer_json(const sim::SimulatedCampaign& simulated);

}  // namespace volcal
