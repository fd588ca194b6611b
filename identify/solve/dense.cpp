#include "volcal/identify/solve/dense.h"

#include <dlfcn.h>

#include <cmath>
#include <stdexcept>
#include <vector>

// NOLINTBEGIN(readability-identifier-naming): the names are LAPACK's
extern "C" {
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dpotri_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dsyevd_(const char* jobz, const char* uplo, const int* n, double* a, const int* lda, double* w,
             double* work, const int* lwork, int* iwork, const int* liwork, int* info);
}
// NOLINTEND(readability-identifier-naming)

namespace volcal {

void use_single_threaded_blas() {
  static const bool done = [] {
    using SetThreads = void (*)(int);
    const auto set_threads = reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
    if (set_threads != nullptr) set_threads(1);
    return true;
  }();
  static_cast<void>(done);
}

std::optional<Eigen::MatrixXd> cholesky_lower(const Eigen::MatrixXd& symmetric) {
  use_single_threaded_blas();
  const int n = static_cast<int>(symmetric.rows());
  Eigen::MatrixXd upper = symmetric;
  int info = 0;
  dpotrf_("U", &n, upper.data(), &n, &info);
  if (info != 0) return std::nullopt;
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(n, n);
  lower.triangularView<Eigen::Lower>() = upper.transpose();
  if (!lower.diagonal().allFinite()) return std::nullopt;
  return lower;
}

Eigen::MatrixXd inverse_from_cholesky(const Eigen::MatrixXd& lower) {
  use_single_threaded_blas();
  const int n = static_cast<int>(lower.rows());
  Eigen::MatrixXd inverse = lower;
  int info = 0;
  dpotri_("L", &n, inverse.data(), &n, &info);
  if (info != 0) throw std::runtime_error("inverse_from_cholesky: singular factor");
  inverse.triangularView<Eigen::StrictlyUpper>() = inverse.transpose();
  return inverse;
}

double log_determinant(const Eigen::MatrixXd& lower) { return 2.0 * lower.diagonal().array().log().sum(); }

SymmetricEigen eigen_decomposition(const Eigen::MatrixXd& symmetric) {
  use_single_threaded_blas();
  const int n = static_cast<int>(symmetric.rows());
  SymmetricEigen result{Eigen::VectorXd(n), symmetric};
  if (n == 0) return result;
  int info = 0, query = -1, integer_size = 0;
  double size = 0.0;
  dsyevd_("V", "U", &n, result.vectors.data(), &n, result.values.data(), &size, &query, &integer_size, &query,
          &info);
  const int work_size = static_cast<int>(size);
  std::vector<double> work(static_cast<std::size_t>(work_size));
  std::vector<int> integers(static_cast<std::size_t>(integer_size));
  dsyevd_("V", "U", &n, result.vectors.data(), &n, result.values.data(), work.data(), &work_size,
          integers.data(), &integer_size, &info);
  if (info != 0) throw std::runtime_error("eigen_decomposition did not converge");
  return result;
}

void symmetrise_from_upper(Eigen::MatrixXd& matrix) {
  matrix.triangularView<Eigen::StrictlyLower>() = matrix.transpose();
}

}  // namespace volcal
