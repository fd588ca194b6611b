#pragma once
/// Positions of rotary axes that contradict what the instrument allows: given in radians, or with the wrong
/// sign.

#include <optional>

#include "volcal/model/description/campaign.h"

namespace volcal {

/// An instrument that names a sphere keeps the nominal tool point at one place, a ball-bar at one distance
/// from its centre ball, a tracking interferometer reads the distance from its station but for a constant.
/// Where the positions as they are read miss that by more than 5 mm, and five times less with positions of
/// rotary axes taken as radians or with the other sign, those axes are named; where no angles mend it, and it
/// is a sphere, the positions. Without such an instrument: an axis whose positions are no round degrees and
/// whole degrees as radians. Without the names of setup and file.
std::optional<Finding> doubtful_angles(const Setup& setup, const Machine& machine);

}  // namespace volcal
