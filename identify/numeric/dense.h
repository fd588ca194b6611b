#pragma once
/// Dense symmetric linear algebra by LAPACK and BLAS. Matrices are column-major; "upper" means only the upper
/// triangle is read or written. BLAS runs on one thread: volcal brings its own, and results must not depend
/// on their number. Matrices without rows or columns are allowed everywhere; LAPACK, which writes a message
/// to standard output for them, is not called.

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

struct PrecisionInverse {
  Eigen::MatrixXd covariance;
  double log_determinant = 0.0;  ///< of the precision
};
/// Of a symmetric matrix that is positive definite but for rounding, as what remains of one when other
/// parameters are integrated out: where its Cholesky factor fails, eigenvalues of the matrix scaled to a unit
/// diagonal that rounding cannot tell from zero (n epsilon) count as that large. Throws std::runtime_error
/// when the diagonal is not positive.
PrecisionInverse invert_precision(const Eigen::MatrixXd& precision);

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< columns
};
/// NaN where the matrix is not finite.
SymmetricEigen eigen_decomposition(const Eigen::MatrixXd& symmetric);
/// Ascending.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric);

struct LeastSquares {
  Eigen::VectorXd solution;  ///< of least norm where the rank is not full
  int rank = 0;
};
/// min |A x - b|; columns count as dependent where the condition number exceeds 1 / `threshold`. NaN and rank
/// 0 where an argument is not finite.
LeastSquares least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double threshold = 1e-15);
/// Orthonormal columns that span {x : rows x = 0}. A direction counts as one of them where |rows x| is less
/// than 3e-7 of the largest that a unit vector reaches.
Eigen::MatrixXd null_space(const Eigen::MatrixXd& rows);

/// upper(C) += A A^T, A is n x k with leading dimension n.
void add_outer_product_upper(const double* a, int n, int k, Eigen::MatrixXd& c);
/// A B.
Eigen::MatrixXd product(const Eigen::Ref<const Eigen::MatrixXd>& a,
                        const Eigen::Ref<const Eigen::MatrixXd>& b);
/// C += A^T B.
void add_transposed_product(const Eigen::Ref<const Eigen::MatrixXd>& a,
                            const Eigen::Ref<const Eigen::MatrixXd>& b, Eigen::MatrixXd& c);
/// R of A = Q R, min(rows, columns) x columns, zero below its diagonal: R^T R = A^T A.
Eigen::MatrixXd upper_factor(Eigen::MatrixXd a);
/// C += A^T R, R of upper_factor(): what is below its diagonal is left out.
void add_transposed_product_upper(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::MatrixXd& r,
                                  Eigen::MatrixXd& c);
/// upper(C) += factor A^T A.
void add_gram_upper(const Eigen::Ref<const Eigen::MatrixXd>& a, double factor, Eigen::MatrixXd& c);
/// B = L^-1 B, L lower triangular.
void solve_lower(const Eigen::MatrixXd& lower, Eigen::MatrixXd& b);
/// A^-1 B for a symmetric positive definite A; throws std::runtime_error when it is not.
Eigen::MatrixXd solve_positive_definite(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);
/// Copies the upper triangle to the lower.
void symmetrise_from_upper(Eigen::MatrixXd& matrix);

}  // namespace volcal
