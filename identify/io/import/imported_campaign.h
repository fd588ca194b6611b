#pragma once
/// Imported files as a campaign: one setup each, held to the checks of campaign_reader.h.

#include "volcal/identify/io/import/import_format.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

struct ImportedFile {
  std::string path;
  std::string setup;  ///< its name
  std::size_t tool = 0;
  ImportedReadings readings;
};

/// Throws InputError: noise that is not stated (--set), keys that the instrument does not know, positions
/// outside the travel and whatever else a campaign is refused for, with the line of the imported file.
Campaign imported_campaign(const std::vector<ImportedFile>& files, const Machine& machine);

/// Comment lines for the head of campaign.toml: what is known of each file, and who says it.
std::string import_comments(const std::vector<ImportedFile>& files);

}  // namespace volcal
