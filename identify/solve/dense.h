#pragma once
/// Dense symmetric linear algebra by LAPACK and BLAS. Matrices are column-major; "upper" means only the upper
/// triangle is read or written. BLAS runs on one thread: volcal brings its own, and results must not depend
/// on their number.

#include <Eigen/Core>
#include <optional>

namespace volcal {

/// Holds BLAS to one thread; cheap, called by every entry point of the solver.
void use_single_threaded_blas();

/// Lower Cholesky factor of a symmetric positive definite matrix (upper triangle read); nullopt when it is
/// not.
std::optional<Eigen::MatrixXd> cholesky_lower(const Eigen::MatrixXd& symmetric);
/// Inverse from a lower Cholesky factor, full symmetric matrix.
Eigen::MatrixXd inverse_from_cholesky(const Eigen::MatrixXd& lower);
/// log det of the matrix whose lower Cholesky factor is given.
double log_determinant(const Eigen::MatrixXd& lower);

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< columns
};
SymmetricEigen eigen_decomposition(const Eigen::MatrixXd& symmetric);

/// Copies the upper triangle to the lower.
void symmetrise_from_upper(Eigen::MatrixXd& matrix);

}  // namespace volcal
