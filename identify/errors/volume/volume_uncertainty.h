#pragma once
/// How well the errors of a machine are known over a volume.

#include <span>

#include "volcal/identify/errors/error_field.h"

namespace volcal {

/// sqrt(mean |u|^2) over poses of the standard uncertainty of the displacement as identified, after the best
/// rigid motion (volume_moments.h), m. Where tables take away what was identified, errors of this size
/// remain. Beyond the readings the functions themselves count, not their held value, and of curves and
/// surfaces what has faded out (faded_in_volume.h). Of errors that are stated without uncertainty that alone.
/// `positions` and `directions` belong together; rotary axes at 0; axes that the
/// machine lacks are left out.
double volume_uncertainty(const FitResult& result, const Tool& tool, const Conditions& conditions,
                          std::span<const AxisPosition> positions,
                          std::span<const ApproachDirection> directions);

}  // namespace volcal
