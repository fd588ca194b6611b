#pragma once
/// Readings that a campaign leaves out, as findings: a number without them is not that of the whole campaign.

#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/finding.h"

namespace volcal {

/// "readings.left-out", one per setup and reason: rows as lines of the file.
std::vector<Finding> left_out_findings(const Campaign& campaign);
/// Those among others.
std::vector<Finding> left_out_among(const std::vector<Finding>& findings);

}  // namespace volcal
