#pragma once
/// The smallest amplitudes of every effect of the catalogue that a campaign would show, before it is
/// measured: what criticism lists after it (criticism/catalogue/detectable.h), from the expected result and
/// independent noise.

#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// `result` must be expected_result() of this campaign. Effects with a shape that is scanned (a period, a
/// time) are taken at the middle one.
std::vector<DetectableEffect> expected_detectable(const Campaign& campaign, const FitResult& result,
                                                  int threads);

}  // namespace volcal
