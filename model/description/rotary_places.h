#pragma once
/// Where an axis stood in a campaign; of a rotary axis places within a turn, those whole turns apart being
/// one.

#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/symbols.h"

namespace volcal {

/// Positions of an axis at the readings that are not left out, ascending, m or rad.
std::vector<double> used_positions(const Campaign& campaign, AxisName axis);

/// rad from 0 to a full turn, ascending; positions nearer to each other than 1e-4 rad are one place. Readings
/// that are left out do not count.
std::vector<double> places_in_turn(const Campaign& campaign, AxisName axis);

/// Most periods a turn that so many places tell from fewer: below half of them. Where the places are regular,
/// a wave of h periods a turn takes the same values at them as one of (places - h), and at half as many
/// periods as places its sine vanishes at all of them.
int most_periods(const std::vector<double>& places);

/// Into how many equal parts the places divide the full turn, all of them at ends of parts; 0: they are not
/// regular.
int regular_parts(const std::vector<double>& places);

}  // namespace volcal
