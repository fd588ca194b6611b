#pragma once
/// Names of direct tests of rotary axes and of drift at rest, as texts, JSON and pages show them.

#include <string>

#include "volcal/identify/standards/standard_figures.h"

namespace volcal {

/// "radial X", "radial, rotating", "axial Z", "tilt about X".
std::string motion_name(const ErrorMotionTest& test);
/// "X displacement", "tilt A", "along the beam".
std::string drift_name(const DriftTest& test);
/// "column 21.3 ... 24.1 degC, ..."; empty without temperatures.
std::string temperatures_text(const DriftTest& test);

}  // namespace volcal
