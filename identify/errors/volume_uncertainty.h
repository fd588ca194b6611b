#pragma once
/// How well the errors of a machine are known over a volume.

#include <span>

#include "volcal/identify/errors/error_field.h"

namespace volcal {

/// sqrt(mean |u|^2) over poses of the standard uncertainty of the displacement as identified, after the best
/// rigid motion, m: trace of the covariance J C J^T (GUM, 5.1.2) in the space that rigid motions leave. Where
/// tables take away what was identified, errors of this size remain. 0 for errors that are stated without
/// uncertainty. `positions` and `directions` belong together; rotary axes at 0; axes that the machine lacks
/// are left out.
double volume_uncertainty(const FitResult& result, const Tool& tool, const Conditions& conditions,
                          std::span<const AxisPosition> positions,
                          std::span<const ApproachDirection> directions);

}  // namespace volcal
