#pragma once
/// Volumetric error as the report shows it: without its best rigid motion, which is a matter of how a frame
/// was aligned (as `volcal validate` estimates the frame of its points). Vectors are drawn on a grid over the
/// travel; sizes are those of the error budget, whose places have no period.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal::report {

/// Error vectors of one tool's functional point; workpiece coordinates, m. Rotary axes stand at 0.
struct ToolVolume {
  std::string tool;
  std::vector<Eigen::Vector3d> point_w;
  std::vector<Eigen::Vector3d> error_w;
  std::vector<Eigen::Vector3d> u_w;        ///< standard uncertainty per component
  std::vector<Eigen::Vector3d> example_w;  ///< an error that correction may leave (remaining_error.h)
  std::vector<bool> extrapolated;
  std::vector<Eigen::Vector3d>
      corner_w;  ///< of the travel: bits of the index = lower or upper ends of the axes

  double error_rms = 0.0;  ///< root mean |e|^2 over the volume, from both directions of approach
  double error_max = 0.0;  ///< largest |e| there and at the ends of travel
  double u_rms = 0.0;      ///< root mean |u|^2 over the volume

  double u_max() const;  ///< largest |u| of what is drawn
};

/// Drawn at `per_axis` positions on each linear axis.
std::vector<ToolVolume> tool_volumes(const FitResult& result, int per_axis);

}  // namespace volcal::report
