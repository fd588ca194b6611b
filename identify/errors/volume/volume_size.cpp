#include "volcal/identify/errors/volume/volume_size.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/errors/volume/volume_moments.h"
#include "volcal/identify/errors/volume/volume_points.h"
#include "volcal/identify/numeric/dense.h"

namespace volcal {
namespace {

constexpr double kFarthest = 8.0;            // u: a draw beyond it is not expected in 10^14
constexpr double kNegligibleMoment = 1e-14;  // of the largest eigenvalue of the moments

using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic>;

/// Derivatives of the error at a pose, and after them the error: few parameters act at a pose.
struct RowsOfPose {
  std::vector<Eigen::Index> acting;
  Rows columns;  ///< of these parameters
  Eigen::Vector3d error;
  Eigen::Matrix<double, 3, 6> rigid;  ///< rigid_motion_rows()

  /// Of all parameters, 3 x parameters + 1.
  Rows all(Eigen::Index parameters) const {
    Rows rows = Rows::Zero(3, parameters + 1);
    rows(Eigen::all, acting) = columns;
    rows.col(parameters) = error;
    return rows;
  }
};

/// The poses of a volume, their errors without the rigid motion of those inside.
class PosesOfVolume {
 public:
  PosesOfVolume(const FitResult& result, const Tool& tool, const Conditions& conditions, int cells_per_axis)
      : covariance_(result.covariance), moments_(result.layout.size + 1) {
    const ErrorField field(result, tool, conditions);
    for (const VolumePose& pose : volume_poses(result.machine, tool, field.effects(),
                                               identified_rotary_axes(result), cells_per_axis)) {
      poses_.push_back(rows_of(field, pose));
      if (pose.inside) moments_.add(pose.place_w, poses_.back().all(parameters()));
    }
    motions_ = moments_.rigid_motions();
    with_motions_ = covariance_ * motions_.leftCols(parameters()).transpose();
    of_motions_ = motions_.leftCols(parameters()) * with_motions_;
  }

  Eigen::MatrixXd moments() const { return moments_.mean(); }
  /// Derivatives of the error, and after them the error, of every pose that can have the largest.
  std::vector<Rows> of_largest() const {
    std::vector<double> size, u;
    double least = 0.0;
    for (const RowsOfPose& pose : poses_) {
      size.push_back((pose.error - pose.rigid * motions_.col(parameters())).norm());
      u.push_back(std::sqrt(std::max(0.0, variance(pose))));
      least = std::max(least, size.back() - kFarthest * u.back());
    }
    std::vector<Rows> all;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (size[i] + kFarthest * u[i] >= least)
        all.emplace_back(poses_[i].all(parameters()) - poses_[i].rigid * motions_);
    }
    return all;
  }

 private:
  static RowsOfPose rows_of(const ErrorField& field, const VolumePose& pose) {
    const Rows rows = field.unheld_rows(pose.position, pose.direction).topRows<3>();
    RowsOfPose of_pose;
    for (Eigen::Index j = 0; j < rows.cols(); ++j) {
      if (!rows.col(j).isZero(0.0)) of_pose.acting.push_back(j);
    }
    of_pose.columns = rows(Eigen::all, of_pose.acting);
    of_pose.error = field.at(pose.position, pose.direction).head<3>();
    of_pose.rigid = rigid_motion_rows(pose.place_w);
    return of_pose;
  }
  Eigen::Index parameters() const { return covariance_.rows(); }
  /// Of the three components together. All parameters act on the rigid motion: its share is taken off that of
  /// the few.
  double variance(const RowsOfPose& pose) const {
    double sum = (pose.rigid * of_motions_ * pose.rigid.transpose()).trace();
    for (std::size_t j = 0; j < pose.acting.size(); ++j) {
      const Eigen::Vector3d column = pose.columns.col(static_cast<Eigen::Index>(j));
      sum -= 2.0 * (pose.rigid * with_motions_.row(pose.acting[j]).transpose()).dot(column);
      for (std::size_t i = 0; i < pose.acting.size(); ++i)
        sum += covariance_(pose.acting[i], pose.acting[j]) *
               column.dot(pose.columns.col(static_cast<Eigen::Index>(i)));
    }
    return sum;
  }

  const Eigen::MatrixXd& covariance_;
  std::vector<RowsOfPose> poses_;
  VolumeMoments moments_;
  Eigen::MatrixXd motions_;       ///< 6 x parameters and one
  Eigen::MatrixXd with_motions_;  ///< covariances of the parameters with the motions
  Eigen::Matrix<double, 6, 6> of_motions_;
};

/// M = L L^T of the parameters that vary, in units of their uncertainty.
struct Root {
  Eigen::MatrixXd transposed;  ///< L^T
  Eigen::VectorXd offset;      ///< c
};
Root root_of(const Eigen::MatrixXd& moments, const Eigen::MatrixXd& covariance) {
  const Eigen::Index parameters = covariance.rows();
  const Eigen::VectorXd u = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const SymmetricEigen eigen =
      eigen_decomposition(u.asDiagonal() * moments.topLeftCorner(parameters, parameters) * u.asDiagonal());
  const double least = kNegligibleMoment * eigen.values.maxCoeff();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < parameters; ++k) {
    if (eigen.values[k] > least) kept.push_back(k);
  }
  const Eigen::VectorXd root = eigen.values(kept).cwiseSqrt();
  const Eigen::MatrixXd vectors = eigen.vectors(Eigen::all, kept);
  const Eigen::VectorXd per_u = (u.array() > 0.0).select(u.array().inverse(), 0.0);
  const Eigen::VectorXd linear = moments.col(parameters).head(parameters);
  return {root.asDiagonal() * vectors.transpose() * per_u.asDiagonal(),
          root.cwiseInverse().asDiagonal() * (vectors.transpose() * (u.asDiagonal() * linear))};
}

}  // namespace

VolumeSize::VolumeSize(const FitResult& result, const Tool& tool, const Conditions& conditions,
                       int cells_per_axis) {
  const PosesOfVolume poses(result, tool, conditions, cells_per_axis);
  const Eigen::MatrixXd moments = poses.moments();
  const Eigen::Index parameters = result.layout.size;
  const Root root = root_of(moments, result.covariance);
  const std::vector<Rows> of_largest = poses.of_largest();
  of_rms_ = root.offset.size();
  const Eigen::Index count = of_rms_ + 3 * static_cast<Eigen::Index>(of_largest.size());
  rows_.resize(count, parameters);
  offset_.resize(count);
  rows_.topRows(of_rms_) = root.transposed;
  offset_.head(of_rms_) = root.offset;
  largest_row_ = Eigen::VectorXd::Zero(parameters);
  Eigen::Index row = of_rms_;
  for (const Rows& pose : of_largest) {
    rows_.middleRows<3>(row) = pose.leftCols(parameters);
    const Eigen::Vector3d error = pose.col(parameters);
    offset_.segment<3>(row) = error;
    if (error.norm() > largest_) {
      largest_ = error.norm();
      largest_row_ = pose.leftCols(parameters).transpose() * error / largest_;
    }
    row += 3;
  }
  const double mean_square = std::max(0.0, moments(parameters, parameters));
  rest_ = mean_square - root.offset.squaredNorm();
  rms_ = std::sqrt(mean_square);
  u_ = std::sqrt(
      std::max(0.0, moments.topLeftCorner(parameters, parameters).cwiseProduct(result.covariance).sum()));
  rms_row_ = moments.col(parameters).head(parameters) * (rms_ > 0.0 ? 1.0 / rms_ : 0.0);
}

VolumeSize::Sizes VolumeSize::sizes(const Eigen::Ref<const Eigen::MatrixXd>& values) const {
  Eigen::ArrayXd mean_square = Eigen::ArrayXd::Constant(values.rows(), rest_);
  for (Eigen::Index k = 0; k < of_rms_; ++k) mean_square += (values.col(k).array() + offset_[k]).square();
  Eigen::ArrayXd most = Eigen::ArrayXd::Zero(values.rows()), square(values.rows());
  for (Eigen::Index first = of_rms_; first < values.cols(); first += 3) {
    square.setZero();
    for (Eigen::Index k = first; k < first + 3; ++k) square += (values.col(k).array() + offset_[k]).square();
    most = most.max(square);
  }
  return {mean_square.max(0.0).sqrt(), most.sqrt()};
}

}  // namespace volcal
