#pragma once
/// Volumetric errors at single points as text and JSON, um and urad.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "volcal/identify/errors/error_tables.h"

namespace volcal {

/// One row per point and tool: the error vector and rotation, each with its expanded uncertainty (95 %, as in
/// error_tables.csv).
std::string volumetric_text(const FitResult& result, const std::vector<VolumetricError>& errors);
/// Keys position (axis letter to mm or deg), tool, error_um, u_um, rotation_urad, u_rotation_urad,
/// extrapolated.
nlohmann::ordered_json volumetric_json(const FitResult& result, const std::vector<VolumetricError>& errors);

}  // namespace volcal
