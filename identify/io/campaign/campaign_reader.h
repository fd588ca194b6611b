#pragma once
/// campaign.toml: setups with their instruments and readings.

#include <string>
#include <vector>

#include "volcal/identify/text/csv_table.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/errors.h"

namespace volcal {

inline constexpr const char* kCampaignFormat = "volcal-campaign-1";

/// Reads a campaign, its machine and all its readings, and checks them against each other
/// (campaign_checks.h); two setups that would give the same readings are refused. Paths inside the file are
/// relative to it. Throws InputError with file, line, problem and remedy.
Campaign read_campaign(const std::string& path);

/// The same without the readings: setups as declared, `readings` empty.
Campaign read_campaign_description(const std::string& path);
Campaign parse_campaign_description(const std::string& text, const std::string& file, const Machine& machine);

/// A campaign whose readings are in memory: `text` is a campaign.toml without the keys `machine` and `data`;
/// `readings` holds, for each of its setups, columns by the names and in the units of a CSV file. The same
/// checks as for files; places are "readings of NAME" and the row, from 1. `name` names the campaign. Throws
/// InputError.
Campaign campaign_in_memory(const std::string& text, const std::string& name, const Machine& machine,
                            const std::vector<std::vector<NumberColumn>>& readings);

}  // namespace volcal
