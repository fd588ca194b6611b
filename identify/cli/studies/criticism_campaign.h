#pragma once
/// One campaign of the study: simulated, fitted, diagnosed and compared with what was hidden.

#include <cstdint>
#include <string>

#include "volcal/identify/cli/studies/criticism_record.h"

namespace volcal::cli {

/// Repeatable to the bit.
CampaignRecord criticise_campaign(const std::string& row, int index, std::uint64_t seed, int readings);

}  // namespace volcal::cli
