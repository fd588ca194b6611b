#pragma once
/// The covariance of the reference problem's 153 parameters at its solution, in two ways.

#include <Eigen/Core>
#include <memory>

#include "reference_problem.h"

namespace volcal::bench {

class CovariancePeers {
 public:
  CovariancePeers(const ReferenceProblem& problem, int threads);
  ~CovariancePeers();

  /// Normal equations of all readings, their Cholesky factor and its inverse, as the fit does it.
  Eigen::MatrixXd from_normal_equations() const;
  /// ceres::Covariance with SPARSE_QR: one residual block per reading, one parameter block per function and
  /// nuisance block. The rows of the Jacobian are given: computing them is not timed.
  Eigen::MatrixXd by_ceres() const;
  std::size_t readings() const;

 private:
  struct Problem;
  std::unique_ptr<Problem> problem_;
};

}  // namespace volcal::bench
