#pragma once
/// Readings that no machine gives.

#include <vector>

#include "volcal/identify/solve/result.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// `on_nominal_machine`: residuals of a machine without errors. Throws InputError for a setup that misses it
/// by 2 % of the longest travel: its readings are in another unit, or another setup's file.
void require_plausible(const Campaign& campaign, const std::vector<SetupSummary>& on_nominal_machine);

}  // namespace volcal
