#pragma once
/// Positions and directions of the axes as they are written on the command line.

#include <string>

#include "volcal/identify/errors/pose.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal::cli {

/// "X=100,Y=-20.5,C=90" in mm and deg; axes that are not named stay at home. Throws InputError naming
/// `option` for what cannot be read, an axis that the machine does not have, or a position outside its
/// travel.
AxisPosition axis_position(const std::string& option, const std::string& text, const Machine& machine);

/// "X+,Y-": axes that are not named are approached from both sides. Throws InputError naming `option`.
ApproachDirection approach_direction(const std::string& option, const std::string& text,
                                     const Machine& machine);

}  // namespace volcal::cli
