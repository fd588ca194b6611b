#pragma once
/// Surfaces of an identified model as reports draw them.

#include <string>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/result/surface_values.h"
#include "volcal/model/description/campaign.h"

namespace volcal::report {

struct DrawnSurface {
  SurfaceValues values;
  SurfaceFigure figure;  ///< a third driver where the value is largest
};

/// With the places of the readings, but for an aligned result, whose frame is another than theirs.
std::vector<DrawnSurface> drawn_surfaces(const FitResult& result, const Campaign& campaign);

/// "surface EAY by y z: up to 12.3 +- 0.8 urad at y = 310 mm, z = -120 mm"
std::string surface_line(const SurfaceValues& surface, double coverage_factor);

}  // namespace volcal::report
