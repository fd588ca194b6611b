#pragma once
/// Sign of a rotary location error in the motion of the tool relative to the workpiece. It is stated for the
/// physical axis line in the machine frame, and a table's axis line moves with the workpiece; a zero position
/// is stated in the sense of the command, on either side.

#include "volcal/model/description/symbols.h"

namespace volcal {

constexpr double rotary_location_sign(bool workpiece_side, AxisName axis, Component component) {
  const bool zero_position = is_rotation(component) && direction_of(component) == direction_of(axis);
  return workpiece_side && !zero_position ? -1.0 : 1.0;
}

}  // namespace volcal
