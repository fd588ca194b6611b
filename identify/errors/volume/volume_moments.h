#pragma once
/// Second moments, over the poses of a volume, of the displacements that each parameter makes, after the best
/// rigid motion, which a frame's alignment takes up. With C the covariance of the parameters and M the
/// moments, trace(C M) is the mean square that their uncertainty leaves in the volume.

#include <Eigen/Core>

namespace volcal {

/// Displacement of a point per unit of a translation and a rotation: t + w x p.
Eigen::Matrix<double, 3, 6> rigid_motion_rows(const Eigen::Vector3d& point);

class VolumeMoments {
 public:
  explicit VolumeMoments(Eigen::Index parameters);

  /// A pose: its point, m, and the displacements per unit of every parameter, 3 x parameters.
  void add(const Eigen::Vector3d& point, const Eigen::Matrix<double, 3, Eigen::Dynamic>& rows);
  /// Mean over the poses of R_i^T R_i, R the displacements less the best rigid motion of each column: least
  /// squares with equal weights; a rotation that the points do not determine is left. Symmetric.
  Eigen::MatrixXd mean() const;
  /// That rigid motion of every column, 6 x parameters: its displacements are rigid_motion_rows() times it.
  Eigen::MatrixXd rigid_motions() const;

 private:
  double poses_ = 0.0;
  Eigen::Matrix<double, 6, 6> rigid_;   ///< sum of B^T B, B the displacements by translations and rotations
  Eigen::MatrixXd rigid_by_parameter_;  ///< sum of B^T R
  Eigen::MatrixXd by_parameter_;        ///< sum of R^T R
};

}  // namespace volcal
