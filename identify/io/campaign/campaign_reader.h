#pragma once
/// campaign.toml: setups with their instruments and readings.

#include <string>

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

}  // namespace volcal
