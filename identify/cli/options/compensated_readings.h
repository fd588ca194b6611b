#pragma once
/// Readings of a machine whose tables were active, for a judgement by the errors that the tables were made
/// from (ISO/TR 16907:2015, 11.3).

#include <string>

#include "volcal/identify/compensation/compensation_tables.h"
#include "volcal/model/description/campaign.h"

namespace volcal::cli {

/// The tables in a folder, by the rules of their controller. Throws InputError.
CompensationTables active_tables(const std::string& folder);

/// What the same readings would be without the tables: less what their corrections of all axes moved, to
/// first order. Angles of a direct measurement lose what rotary axes were turned by and nothing else, since
/// the linear axes' corrections turn nothing (11.3 b). Stations, centres and alignments are those that the
/// readings give: guesses of them may be far off.
Campaign without_corrections(Campaign campaign, const CompensationTables& tables, int threads = 0);

}  // namespace volcal::cli
