#pragma once
/// One campaign of the study: simulated, fitted, diagnosed and compared with what was hidden.

#include <cstdint>
#include <optional>
#include <string>

#include "volcal/identify/criticism/data/search_rules.h"
#include "volcal/sim/study.h"
#include "volcal/studies/criticism/criticism_record.h"

namespace volcal::studies {

/// Repeatable to the bit.
CampaignRecord criticise_campaign(const std::string& row, int index, std::uint64_t seed, int readings,
                                  const SearchRules& rules = {});

/// The same campaign for itself; none where no effect drawn is visible.
std::optional<sim::Study> study_of_campaign(const std::string& row, int index, std::uint64_t seed,
                                            int readings);

}  // namespace volcal::studies
