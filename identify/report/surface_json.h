#pragma once
/// A surface or curve as the lens of the pages takes it (web/src/lenses/surface.js).

#include "volcal/identify/report/page.h"
#include "volcal/identify/report/values/drawn_surfaces.h"

namespace volcal::report {

/// label, target, factor, unit; axes with title, places and dots; value and U95 in `unit`, those of the last
/// axis next to each other; largest with its U95 and place; rms.
Json surface_json(const DrawnSurface& surface, double coverage_factor);

}  // namespace volcal::report
