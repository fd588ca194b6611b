#pragma once
/// The table [record] of campaign.toml: what a person knows of the measurement and no reading says.

#include <string>

#include "volcal/identify/compensation/measurement_record.h"
#include "volcal/identify/text/toml_document.h"

namespace volcal {

/// [record] of a campaign's root, and its active_compensations. Throws InputError for a text that is empty,
/// for active_compensations inside the table, and for instruments that are not known.
MeasurementRecord read_record(const TomlTable& campaign);

/// That of a campaign file. Nothing else of it is looked at. Throws InputError.
MeasurementRecord read_campaign_record(const std::string& path);
/// Of a text that holds the table alone; `name` stands for the file in messages. Throws InputError.
MeasurementRecord parse_record(const std::string& text, const std::string& name);
/// The table again, without active_compensations; empty where nothing was recorded.
std::string record_toml(const MeasurementRecord& record);

}  // namespace volcal
