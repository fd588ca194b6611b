#pragma once
/// Sizes of a set of volumetric errors: vectors actual minus nominal of the functional point, m.

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace volcal {

struct VolumetricFigures {
  int points = 0;
  Eigen::Vector3d range = Eigen::Vector3d::Zero();  ///< max - min of ex, ey, ez
  double rms = 0.0;                                 ///< sqrt(mean |e|^2)
  double max = 0.0;                                 ///< largest |e|
};

/// No points give zero points and zero figures.
VolumetricFigures volumetric_figures(std::span<const Eigen::Vector3d> errors);

/// Errors without their best rigid motion t + w x (p - mean p), least squares with equal weights: what is
/// left does not depend on how the points' frame was aligned. A rotation that the points do not determine
/// (points on one line) is left at zero.
std::vector<Eigen::Vector3d> without_rigid_motion(std::span<const Eigen::Vector3d> points,
                                                  std::span<const Eigen::Vector3d> errors);
/// The motion is that of the first `fitted` points, and is taken from all.
std::vector<Eigen::Vector3d> without_rigid_motion(std::span<const Eigen::Vector3d> points,
                                                  std::span<const Eigen::Vector3d> errors,
                                                  std::size_t fitted);

}  // namespace volcal
