#include "volcal/identify/errors/volume/volume_moments.h"

#include <Eigen/Geometry>
#include <vector>

#include "volcal/identify/numeric/dense.h"

namespace volcal {
namespace {

constexpr double kUndetermined = 1e-12;  // of the largest eigenvalue of the rigid motions' moments

}  // namespace

Eigen::Matrix<double, 3, 6> rigid_motion_rows(const Eigen::Vector3d& point) {
  Eigen::Matrix<double, 3, 6> rows;
  rows << Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) rows.col(3 + k) = Eigen::Vector3d::Unit(k).cross(point);
  return rows;
}

VolumeMoments::VolumeMoments(Eigen::Index parameters)
    : rigid_(Eigen::Matrix<double, 6, 6>::Zero()),
      rigid_by_parameter_(Eigen::MatrixXd::Zero(6, parameters)),
      by_parameter_(Eigen::MatrixXd::Zero(parameters, parameters)) {}

void VolumeMoments::add(const Eigen::Vector3d& point, const Eigen::Matrix<double, 3, Eigen::Dynamic>& rows) {
  poses_ += 1.0;
  const Eigen::Matrix<double, 3, 6> rigid = rigid_motion_rows(point);
  rigid_ += rigid.transpose() * rigid;
  std::vector<Eigen::Index> acting;  // most functions of a spline are zero at a pose
  for (Eigen::Index j = 0; j < rows.cols(); ++j) {
    if (!rows.col(j).isZero(0.0)) acting.push_back(j);
  }
  for (const Eigen::Index j : acting) {
    const Eigen::Vector3d column = rows.col(j);
    rigid_by_parameter_.col(j) += rigid.transpose() * column;
    for (const Eigen::Index i : acting) by_parameter_(i, j) += rows.col(i).dot(column);
  }
}

Eigen::MatrixXd VolumeMoments::rigid_motions() const {
  const SymmetricEigen eigen = eigen_decomposition(rigid_);
  const double least = kUndetermined * eigen.values.maxCoeff();
  const Eigen::VectorXd inverse = (eigen.values.array() > least).select(eigen.values.array().inverse(), 0.0);
  return eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose() * rigid_by_parameter_;
}

Eigen::MatrixXd VolumeMoments::mean() const {
  if (poses_ == 0.0) return by_parameter_;
  const SymmetricEigen eigen = eigen_decomposition(rigid_);
  const double least = kUndetermined * eigen.values.maxCoeff();
  const Eigen::MatrixXd turned = eigen.vectors.transpose() * rigid_by_parameter_;
  Eigen::MatrixXd moments = by_parameter_;
  for (Eigen::Index k = 0; k < 6; ++k) {
    if (eigen.values[k] > least)
      moments -= turned.row(k).transpose() * turned.row(k) * (1.0 / eigen.values[k]);
  }
  return moments / poses_;
}

}  // namespace volcal
