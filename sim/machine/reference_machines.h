#pragma once
/// Four structures, 0.5-2.5 m of travel, with three tools (two of them sideways), for studies and tests.

#include <array>
#include <string>
#include <vector>

#include "volcal/model/description/machine.h"

namespace volcal::sim {

/// A machine from its code: reference points and rotary centres at the origin, datum primary X, secondary Y.
/// `linear_travel`: X, Y, Z, from-to, m; home is the lower end. Rotary axes: one turn about 0, home 0.
/// Tools: short (0, 0, -150), side_x (110, 15, -240), side_y (-20, 130, -280) mm.
Machine machine_from_code(const std::string& code, const std::array<std::array<double, 2>, 3>& linear_travel);

/// `w X b Y Z t` 1000 x 600 x 500 mm, `w X' Y' b Z t` 800 x 500 x 450 mm about the middle,
/// `w b X Y Z t` 2500 x 1200 x 800 mm, `w Y' b X Z t` 500 x 400 x 330 mm.
std::vector<Machine> reference_machines();

}  // namespace volcal::sim
