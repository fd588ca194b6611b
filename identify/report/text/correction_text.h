#pragma once
/// What tables, read back, add to the commands at single points, as text and JSON; mm and um.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "volcal/identify/compensation/compensation_tables.h"

namespace volcal {

/// Two rows per point: every axis approached towards +, every axis towards -.
std::string corrections_text(const Machine& machine, const CompensationTables& tables,
                             const std::vector<AxisPosition>& points);
/// Keys position (axis letter to mm) and correction_um: from the directions of X Y Z, as "+-+", to the
/// corrections of X Y Z.
nlohmann::ordered_json corrections_json(const Machine& machine, const CompensationTables& tables,
                                        const std::vector<AxisPosition>& points);

}  // namespace volcal
