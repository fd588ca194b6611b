#pragma once
/// Machines with three linear and two rotary axes over which studies count.

#include <string>
#include <vector>

#include "volcal/model/description/machine.h"

namespace volcal::studies {

/// Table, head, one on either side, and a table that tilts about Y.
const std::vector<std::string>& five_axis_structures();

/// Two rotary axes, tools of 150 and 300 mm and a mandrel 60 mm to the side; linear travel +-800 mm.
Machine five_axis_machine(const std::string& structure);

/// A or B, whichever the machine has beside C.
AxisName tilting_axis(const Machine& machine);

}  // namespace volcal::studies
