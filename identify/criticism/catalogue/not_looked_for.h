#pragma once
/// Effects that a diagnosis cannot look for, because the readings do not record what drives them.

#include <vector>

#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// A finding for the directions of approach that are known nowhere though the axis moves, and one for the
/// time, each with the kinds of effects that need them. `families`: those that the diagnosis tests.
std::vector<Finding> not_looked_for(const Campaign& campaign, const std::vector<Family>& families);

}  // namespace volcal
