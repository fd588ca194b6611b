#pragma once
/// What is noticed while a campaign is read and is no error: columns that nobody reads, readings that look
/// like a slip, directions of approach that no file records, axes of rotation that stand nobody says where.
/// Each adds findings to `Campaign::notes`.

#include <vector>

#include "volcal/identify/io/campaign/column_choice.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// Names the columns of the setup's file that were not read, and the `columns` key that would read those
/// which look like a standard column.
void note_unused_columns(const std::vector<UnusedColumn>& unused, const Setup& setup, Campaign& campaign);

/// Rows that stand in a file twice, setups with the same readings, directions against the order of the
/// positions, times that no machine keeps.
void note_doubtful_readings(Campaign& campaign);

/// Fills the `dir_` columns that a file lacks from the order of its readings (standards/approach.h), where
/// `derive` says so by setup, and notes it once. Directions of an axis that would be the same in the whole
/// campaign stay unknown: nothing can be learnt from them.
void derive_directions(const std::vector<bool>& derive, Campaign& campaign);

/// Notes rotary axes that move although nobody stated where they stand.
void note_assumed_centres(Campaign& campaign);

}  // namespace volcal
