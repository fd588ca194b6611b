#pragma once
/// Homogeneous transforms (4x4) and what is needed to compare point sets. m and rad.

#include <Eigen/Core>
#include <vector>

#include "volcal/model/description/symbols.h"

namespace volcal::sim {

/// Direction of a linear axis.
Eigen::Vector3d unit(AxisName axis);
Eigen::Matrix4d translation(const Eigen::Vector3d& v);
/// Rotation by `angle` about coordinate direction 0..2.
Eigen::Matrix4d rotation_about(int direction, double angle);
/// 3-2-1 rotation Rz(angles.z) Ry(angles.y) Rx(angles.x).
Eigen::Matrix4d rotation_321(const Eigen::Vector3d& angles);
/// Inverse of a rigid transform.
Eigen::Matrix4d inverse(const Eigen::Matrix4d& transform);
/// Rotation vector (axis times angle) of a rotation matrix; angle in [0, pi).
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation);

/// Small rigid motion e = translation + rotation x p.
struct RigidMotion {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
};

/// Least-squares small rigid motion that explains the error vectors `error` at `point` (equal sizes, at least
/// 3 points that are not on one line).
RigidMotion best_rigid_motion(const std::vector<Eigen::Vector3d>& point,
                              const std::vector<Eigen::Vector3d>& error);
/// sqrt(mean |e|^2) of what the best rigid motion leaves, in the unit of `error`.
double rms_after_alignment(const std::vector<Eigen::Vector3d>& point,
                           const std::vector<Eigen::Vector3d>& error);

}  // namespace volcal::sim
