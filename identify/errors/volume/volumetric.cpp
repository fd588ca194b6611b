#include "volcal/identify/errors/volume/volumetric.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "volcal/identify/numeric/dense.h"

namespace volcal {
namespace {

Eigen::Vector3d mean_of(std::span<const Eigen::Vector3d> vectors) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& vector : vectors) sum += vector;
  return sum / static_cast<double>(vectors.size());
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& arm) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -arm.z(), arm.y(), arm.z(), 0.0, -arm.x(), -arm.y(), arm.x(), 0.0;
  return matrix;
}

}  // namespace

VolumetricFigures volumetric_figures(std::span<const Eigen::Vector3d> errors) {
  VolumetricFigures figures;
  if (errors.empty()) return figures;
  Eigen::Vector3d low = errors.front(), high = errors.front();
  double squares = 0.0;
  for (const auto& error : errors) {
    low = low.cwiseMin(error);
    high = high.cwiseMax(error);
    squares += error.squaredNorm();
    figures.max = std::max(figures.max, error.norm());
  }
  figures.points = static_cast<int>(errors.size());
  figures.range = high - low;
  figures.rms = std::sqrt(squares / figures.points);
  return figures;
}

RigidMotion best_rigid_motion(std::span<const Eigen::Vector3d> points,
                              std::span<const Eigen::Vector3d> errors) {
  if (points.size() != errors.size()) throw std::invalid_argument("as many points as errors are needed");
  if (points.empty()) return {};
  RigidMotion motion{mean_of(points), mean_of(errors)};
  const auto rows = static_cast<Eigen::Index>(3 * points.size());
  Eigen::MatrixXd turn(rows, 3);
  Eigen::VectorXd rest(rows);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    turn.middleRows<3>(row) = -cross_matrix(points[i] - motion.centre);  // w x arm = -arm x w
    rest.segment<3>(row) = errors[i] - motion.translation;
  }
  motion.rotation = least_squares(turn, rest).solution;
  return motion;
}

std::vector<Eigen::Vector3d> without_rigid_motion(std::span<const Eigen::Vector3d> points,
                                                  std::span<const Eigen::Vector3d> errors) {
  return without_rigid_motion(points, errors, points.size());
}

std::vector<Eigen::Vector3d> without_rigid_motion(std::span<const Eigen::Vector3d> points,
                                                  std::span<const Eigen::Vector3d> errors,
                                                  std::size_t fitted) {
  if (points.size() != errors.size()) throw std::invalid_argument("as many points as errors are needed");
  if (fitted > points.size()) throw std::invalid_argument("more points to fit than there are");
  const RigidMotion motion = best_rigid_motion(points.first(fitted), errors.first(fitted));
  std::vector<Eigen::Vector3d> result;
  for (std::size_t i = 0; i < points.size(); ++i) result.emplace_back(errors[i] - motion.at(points[i]));
  return result;
}

}  // namespace volcal
