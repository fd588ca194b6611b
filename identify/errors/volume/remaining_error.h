#pragma once
/// What an identification leaves open: with the identified errors corrected, the field of volumetric errors
/// that remains is one of those that the covariance of its parameters allows.

#include <Eigen/Core>
#include <span>
#include <vector>

namespace volcal {

/// Per point, m, after the best rigid motion (volumetric.h).
struct RemainingError {
  std::vector<Eigen::Vector3d> u;        ///< standard uncertainty of each component
  std::vector<Eigen::Vector3d> example;  ///< one field of those possible, drawn from the joint distribution
};

class RemainingErrors {
 public:
  /// `covariance` of the parameters, positive semidefinite; without rows where nothing is uncertain. The same
  /// draw of the parameters serves every set of points.
  explicit RemainingErrors(const Eigen::MatrixXd& covariance);

  /// `derivatives` of the errors to the parameters: three rows per point.
  RemainingError at(std::span<const Eigen::Vector3d> points, const Eigen::MatrixXd& derivatives) const;

 private:
  Eigen::MatrixXd root_;  ///< root root^T = covariance
  Eigen::VectorXd draw_;  ///< independent standard normal values
};

}  // namespace volcal
