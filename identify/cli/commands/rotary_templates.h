#pragma once
/// What `volcal init` writes for a machine with rotary axes: axes about which spheres can be measured, the
/// setups that show rotary errors, and a study that measures them on a simulated machine.

#include <string>
#include <vector>

#include "volcal/model/description/machine.h"

namespace volcal::cli {

bool has_rotary_axes(const Structure& structure);

/// [axes.NAME] of a machine with rotary axes: a table's axes meet in the working volume, those of a head
/// above the spindle's nose; the linear axes reach every sphere of the template at every pose.
std::string axis_table_beside_rotary(AxisName axis, const Structure& structure);

/// [tools.NAME]: two lengths and one with a lateral offset.
std::string rotary_tools(const Structure& structure);

/// Commented setups, spheres that the tool point stays on, or of axes that two linear axes cannot follow
/// tests of each alone. Their readings have the columns `positions` of commanded positions.
std::string rotary_setups(const Structure& structure, const std::string& positions);

/// Instruments that rotary_setups() shows.
std::vector<std::string> rotary_instruments(const Structure& structure);

/// study.toml: what rotary_setups() asks for and the linear axes, measured on a random machine. Empty for a
/// structure of fewer than two linear axes.
std::string rotary_study(const Structure& structure);

}  // namespace volcal::cli
