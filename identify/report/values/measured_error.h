#pragma once
/// What the readings of a campaign show of a machine without any model of its errors: their deviations from
/// the machine without errors, of which only stations, dead paths, alignments and the like are estimated.
/// Measured before tables are loaded and again with them active, it says what they have changed.

#include <string>

#include "volcal/identify/compensation/active_tables.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

struct MeasuredError {
  std::string campaign;              ///< file
  std::string active_compensations;  ///< while it was measured, in words; empty = not stated
  std::size_t setups = 0;
  ErrorSizes sizes;  ///< of readings minus those of the machine without errors
};

/// Throws InputError where the campaign cannot be evaluated.
MeasuredError measured_error(const Campaign& campaign, int threads = 0);

/// What a campaign shows that was measured with tables active. Its readings become what they would be without
/// the tables, with those that they stand in place of: less what the corrections of all axes moved beyond
/// these, to first order. Angles of a direct measurement lose what rotary axes were turned by and nothing
/// else, since the linear axes' corrections turn nothing (ISO/TR 16907:2015, 11.3 b). Its notes say what is
/// doubtful.
MeasuredError take_out_tables(const ActiveTables& tables, const FitResult& errors, Campaign& campaign,
                              int threads = 0);

/// Throws InputError where the result was not identified from readings of the campaign.
void require_campaign_of(const FitResult& result, const Campaign& campaign);

}  // namespace volcal
