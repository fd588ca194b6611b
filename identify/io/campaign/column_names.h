#pragma once
/// What a column may be meant to be that is called otherwise than the standard has it.

#include <string>
#include <string_view>
#include <vector>

#include "volcal/model/description/machine.h"

namespace volcal {

/// The one of `missing` (standard names: dir_x, time_s, line, run, feed_mm_min, sigma_um) that `name`
/// resembles in words: "direction_x", "dirx", "Time [s]", "cycle"; or "T_x_degC" for "temp_x", "T_air_degC"
/// for "T air [°C]". Empty: none.
std::string meant_column(const std::string& name, const std::vector<std::string>& missing,
                         const Machine& machine);

/// As headers write it: "degC", "°C", "C".
bool is_degree_celsius(std::string_view unit);

}  // namespace volcal
