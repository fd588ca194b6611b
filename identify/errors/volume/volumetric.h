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

/// translation + rotation x (p - centre).
struct RigidMotion {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();       ///< m
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();     ///< rad

  Eigen::Vector3d at(const Eigen::Vector3d& point) const {
    return translation + rotation.cross(point - centre);
  }
};

/// Of least squares with equal weights; the centre is the mean of the points. A rotation that the points do
/// not determine (points on one line) is zero. Throws std::invalid_argument where counts differ.
RigidMotion best_rigid_motion(std::span<const Eigen::Vector3d> points,
                              std::span<const Eigen::Vector3d> errors);

/// Errors without their best rigid motion: what is left does not depend on how the points' frame was aligned.
std::vector<Eigen::Vector3d> without_rigid_motion(std::span<const Eigen::Vector3d> points,
                                                  std::span<const Eigen::Vector3d> errors);
/// The motion is that of the first `fitted` points, and is taken from all.
std::vector<Eigen::Vector3d> without_rigid_motion(std::span<const Eigen::Vector3d> points,
                                                  std::span<const Eigen::Vector3d> errors,
                                                  std::size_t fitted);

}  // namespace volcal
