#pragma once
/// Which residuals a plot shows when there are more than it can.

#include <vector>

#include "volcal/identify/result/result.h"

namespace volcal::report {

/// Found by the outlier test: flagged, or taken out of the adjustment.
bool is_suspect(const ResidualRecord& record);

/// Indices of at most `limit` residuals, ascending: all of them when they fit; else the flagged and the
/// largest ones (at most half of the limit) and an even pseudo-random choice of the rest, the same on every
/// run.
std::vector<std::size_t> residual_sample(const std::vector<ResidualRecord>& residuals, std::size_t limit);

}  // namespace volcal::report
