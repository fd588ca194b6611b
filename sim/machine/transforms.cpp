#include "volcal/sim/machine/transforms.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

namespace volcal::sim {
namespace {

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace

Eigen::Vector3d unit(AxisName axis) { return Eigen::Vector3d::Unit(direction_of(axis)); }

Eigen::Matrix4d translation(const Eigen::Vector3d& v) {
  Eigen::Matrix4d t = Eigen::Matrix4d::Identity();
  t.topRightCorner<3, 1>() = v;
  return t;
}

Eigen::Matrix4d rotation_about(int direction, double angle) {
  const int next = (direction + 1) % 3;
  const int last = (direction + 2) % 3;
  Eigen::Matrix4d t = Eigen::Matrix4d::Identity();
  t(next, next) = t(last, last) = std::cos(angle);
  t(last, next) = std::sin(angle);
  t(next, last) = -t(last, next);
  return t;
}

Eigen::Matrix4d rotation_321(const Eigen::Vector3d& angles) {
  return rotation_about(2, angles.z()) * rotation_about(1, angles.y()) * rotation_about(0, angles.x());
}

Eigen::Matrix4d inverse(const Eigen::Matrix4d& transform) {
  Eigen::Matrix4d t = Eigen::Matrix4d::Identity();
  t.topLeftCorner<3, 3>() = transform.topLeftCorner<3, 3>().transpose();
  t.topRightCorner<3, 1>() = -t.topLeftCorner<3, 3>() * transform.topRightCorner<3, 1>();
  return t;
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation) {
  const Eigen::Vector3d twice_sine_axis{rotation(2, 1) - rotation(1, 2), rotation(0, 2) - rotation(2, 0),
                                        rotation(1, 0) - rotation(0, 1)};
  const double sine = 0.5 * twice_sine_axis.norm();
  if (sine == 0.0) return Eigen::Vector3d::Zero();
  const double angle = std::atan2(sine, 0.5 * (rotation.trace() - 1.0));
  return twice_sine_axis * (0.5 * angle / sine);
}

RigidMotion best_rigid_motion(const std::vector<Eigen::Vector3d>& point,
                              const std::vector<Eigen::Vector3d>& error) {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < point.size(); ++i) {
    centroid += point[i];
    mean += error[i];
  }
  centroid /= static_cast<double>(point.size());
  mean /= static_cast<double>(point.size());
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < point.size(); ++i) {
    const Eigen::Vector3d arm = point[i] - centroid;
    normal += cross_matrix(arm).transpose() * cross_matrix(arm);
    right += arm.cross(error[i] - mean);
  }
  RigidMotion motion;
  motion.rotation = normal.ldlt().solve(right);
  motion.translation = mean - motion.rotation.cross(centroid);
  return motion;
}

double rms_after_alignment(const std::vector<Eigen::Vector3d>& point,
                           const std::vector<Eigen::Vector3d>& error) {
  const RigidMotion motion = best_rigid_motion(point, error);
  double sum = 0.0;
  for (std::size_t i = 0; i < point.size(); ++i) {
    sum += (error[i] - motion.translation - motion.rotation.cross(point[i])).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(point.size()));
}

}  // namespace volcal::sim
