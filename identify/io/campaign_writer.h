#pragma once
/// Campaigns written as files that campaign_reader.h reads back: campaign.toml and one CSV per setup.
/// Lengths have 7 decimals of a millimetre and 4 of a micrometre (0.1 nm), angles 4 of a microradian and 10
/// of a degree; the numbers of campaign.toml come back to rounding.

#include <string>
#include <vector>

#include "volcal/model/description/campaign.h"

namespace volcal {

/// A column of readings as a CSV file has it.
struct ReadingColumn {
  std::string name;  ///< with its unit: "x_mm"
  double si_per_unit = 1.0;
  int decimals = 0;            ///< that are written
  std::vector<double> values;  ///< SI
};
/// Time, line, run, axes, directions, feed, temperatures, sigma, reading, as far as they were recorded.
/// Throws std::invalid_argument for an instrument that is not registered.
std::vector<ReadingColumn> reading_columns(const Setup& setup, const Machine& machine);

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
