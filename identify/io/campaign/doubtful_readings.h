#pragma once
/// Readings that a file can hold and that a measurement hardly gives.

#include <vector>

#include "volcal/model/description/campaign.h"

namespace volcal {

/// Rows that repeat earlier ones, directions of approach against the order of the positions, times in another
/// unit than seconds, positions of rotary axes in radians or with the wrong sign; without the names of setup
/// and file.
std::vector<Finding> doubts_of(const Setup& setup, const Machine& machine);

/// Two setups of one instrument read the same values at the same positions with the same tool.
bool same_readings(const Setup& one, const Setup& other);

}  // namespace volcal
