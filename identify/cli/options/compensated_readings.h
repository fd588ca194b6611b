#pragma once
/// Readings of a machine whose tables were active, for a judgement by the errors that the tables were made
/// from (ISO/TR 16907:2015, 11.3).

#include <string>

#include "volcal/identify/cli/options/superimposed_tables.h"
#include "volcal/model/description/campaign.h"

namespace volcal::cli {

/// What the same readings would be without the tables, with those that they stand in place of: less what the
/// corrections of all axes moved beyond these, to first order. Angles of a direct measurement lose what
/// rotary axes were turned by and nothing else, since the linear axes' corrections turn nothing (11.3 b).
/// Stations, centres and alignments are those that the readings give: guesses of them may be far off.
Campaign without_corrections(Campaign campaign, const ActiveTables& tables, int threads = 0);

}  // namespace volcal::cli
