#pragma once
/// Weighted least squares with priors by Ceres. The readings enter as one compressed cost function: it
/// accumulates M = J^T W J and the gradient g, factors M + prior = L L^T and hands Ceres the Jacobian L^T
/// with residual (L^-1 g, sqrt(2 cost - |L^-1 g|^2)), so that Ceres sees the exact cost, gradient and
/// Gauss-Newton model and keeps its trust region and convergence tests. While steps contract, M is kept from
/// an earlier point (chord method: exact cost and gradient, M of a Jacobian that hardly changes).
/// `SolverKind::PerReading` is the plain problem, one residual block per reading, solved by SuiteSparse's
/// sparse Cholesky: the reference that tests hold the compressed form to, and the path for what it cannot
/// take.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "volcal/identify/solve/normals/datum.h"
#include "volcal/identify/solve/normals/normal_equations.h"

namespace volcal {

enum class SolverKind { Compressed, PerReading };
enum class RobustLoss { None, Huber, Cauchy };

/// Gaussian prior in reduced coordinates: 1/2 (z - mean)^T precision (z - mean).
struct GaussianPrior {
  Eigen::MatrixXd precision;
  Eigen::VectorXd mean;

  static GaussianPrior none(int size);
  double cost(const Eigen::VectorXd& z) const;
  Eigen::VectorXd gradient(const Eigen::VectorXd& z) const { return precision * (z - mean); }
};

struct MinimiseOptions {
  SolverKind solver = SolverKind::Compressed;
  RobustLoss loss = RobustLoss::None;
  double loss_width = 3.0;  ///< in standard deviations
  int threads = 1;
  int max_iterations = 100;
  double function_tolerance = 1e-12;
  /// Least squares over so many observations or more begins on a sample of them (sample_start.h).
  std::size_t sample_from = 65536;
};

struct MinimiseSummary {
  bool converged = false;
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  std::string message;
};

/// Minimises over the reduced coordinates `z`, which holds start and result.
MinimiseSummary minimise(const ReadingIndex& index, const std::vector<double>& weight,
                         const DatumSpace& datum, const GaussianPrior& prior, const MinimiseOptions& options,
                         Eigen::VectorXd& z);

}  // namespace volcal
