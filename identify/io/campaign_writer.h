#pragma once
/// Campaigns written as files that campaign_reader.h reads back: campaign.toml and one CSV per setup.
/// Lengths have 7 decimals of a millimetre and 4 of a micrometre (0.1 nm), angles 4 of a microradian and 10
/// of a degree; the numbers of campaign.toml come back to rounding.

#include <string>

#include "volcal/model/description/campaign.h"

namespace volcal {

/// File of a setup's readings: its name with characters that file systems dislike replaced, and ".csv".
std::string readings_file_name(const Setup& setup);

/// campaign.toml; `machine_path` is what its `machine` key shall say. Throws std::invalid_argument for an
/// instrument that is not registered and for two setups whose files would have one name.
std::string campaign_toml(const Campaign& campaign, const std::string& machine_path);

/// Readings of a setup: axes, direction, clock, line, run, feed, temperatures, sigma, reading.
std::string readings_csv(const Setup& setup, const Machine& machine);

/// Writes campaign.toml and the CSV files into a folder that exists.
void write_campaign(const Campaign& campaign, const std::string& folder, const std::string& machine_path);

}  // namespace volcal
