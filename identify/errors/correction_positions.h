#pragma once
/// Where the tables of one axis have their rows.

#include <vector>

#include "volcal/model/description/machine.h"

namespace volcal {

/// Home and every `step` (m) from it. Otherwise within the travel and with both its ends; equidistant tables
/// reach beyond it where the travel is no multiple of the step. Throws InputError for a step out of range.
std::vector<double> correction_positions(const Axis& axis, double step, bool equidistant);

}  // namespace volcal
