#pragma once
/// Readings that no machine gives.

#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// `setups` summarise `records`, the residuals of `machine`, "nominal" or "fitted". Throws InputError for a
/// setup that misses it by 2 % of the longest travel: one reading is a blunder, readings are in another unit
/// or another setup's file, or the setup is described wrongly. Names the line of the worst reading.
void require_plausible(const Campaign& campaign, const std::vector<ResidualRecord>& records,
                       const std::vector<SetupSummary>& setups, const std::string& machine);

}  // namespace volcal
