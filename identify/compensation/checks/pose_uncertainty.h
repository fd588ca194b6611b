#pragma once
/// How well errors are known at poses of all axes: what tables that correct them put into the machine.

#include <span>

#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"

namespace volcal {

/// sqrt(mean |u|^2) of the standard uncertainty of displacements of the functional point, after the best
/// rigid motion of the workpiece, which its alignment takes up, m. Beyond the readings the functions
/// themselves count, and what has faded out (volume_uncertainty.h).
struct PoseUncertainty {
  double all = 0.0;        ///< all identified errors together
  double rotary = 0.0;     ///< errors of rotary axes alone
  double corrected = 0.0;  ///< of these what the type of the options corrects
};
PoseUncertainty pose_uncertainty(const FitResult& result, const TableFormatOptions& options,
                                 std::span<const ApproachedPose> poses);

}  // namespace volcal
