#pragma once
/// What is said beside figures of ISO 230-2, of linear and of rotary axes.

#include <vector>

#include "volcal/identify/standards/iso230_2.h"
#include "volcal/identify/standards/setup_values.h"
#include "volcal/model/description/finding.h"

namespace volcal {

/// Readings that were taken as one target, have no direction or were removed; targets met from one side;
/// figures that are undefined. `unit`: "um" or "urad" of the positions.
std::vector<Finding> notes_on_positioning(const PositioningFigures& figures, const SetupValues& values,
                                          const char* unit);

}  // namespace volcal
