#include "volcal/identify/numeric/dense.h"

#include <dlfcn.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <vector>

// NOLINTBEGIN(readability-identifier-naming): the names are LAPACK's
extern "C" {
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dtrtri_(const char* uplo, const char* diag, const int* n, double* a, const int* lda, int* info);
void dlauum_(const char* uplo, const int* n, double* a, const int* lda, int* info);
void dtrmm_(const char* side, const char* uplo, const char* transa, const char* diag, const int* m,
            const int* n, const double* alpha, const double* a, const int* lda, double* b, const int* ldb);
void dsyevd_(const char* jobz, const char* uplo, const int* n, double* a, const int* lda, double* w,
             double* work, const int* lwork, int* iwork, const int* liwork, int* info);
void dgelsy_(const int* m, const int* n, const int* nrhs, double* a, const int* lda, double* b,
             const int* ldb, int* jpvt, const double* rcond, int* rank, double* work, const int* lwork,
             int* info);
void dgeqrf_(const int* m, const int* n, double* a, const int* lda, double* tau, double* work,
             const int* lwork, int* info);
void dpotrs_(const char* uplo, const int* n, const int* nrhs, const double* a, const int* lda, double* b,
             const int* ldb, int* info);
void dsyrk_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha,
            const double* a, const int* lda, const double* beta, double* c, const int* ldc);
void dgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k,
            const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
            const double* beta, double* c, const int* ldc);
void dtrsm_(const char* side, const char* uplo, const char* transa, const char* diag, const int* m,
            const int* n, const double* alpha, const double* a, const int* lda, double* b, const int* ldb);
}
// NOLINTEND(readability-identifier-naming)

namespace volcal {
namespace {

/// Whether the process may only have so much memory (ulimit -v, ulimit -d).
bool memory_is_limited() {
  static const bool limited = [] {
    const auto limits = [](auto which) {
      rlimit limit{};
      return ::getrlimit(which, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
    };
    return limits(RLIMIT_AS) || limits(RLIMIT_DATA);
  }();
  return limited;
}

/// Every thread inside OpenBLAS holds a buffer of 128 MiB, and where none is to be had OpenBLAS tries for
/// ever. Under a limit of memory one thread is let in at a time, so that the first buffer serves all.
class BlasCall {
 public:
  BlasCall() {
    if (memory_is_limited()) lock_ = std::unique_lock(one_at_a_time());
  }

 private:
  static std::mutex& one_at_a_time() {
    static std::mutex mutex;
    return mutex;
  }
  std::unique_lock<std::mutex> lock_;
};

/// The first buffer, while there is room: identify/cli/memory_limit.cpp has looked.
void fetch_buffer() {
  const BlasCall call;
  const int one = 1;
  double number = 1.0;
  int info = 0;
  dpotrf_("U", &one, &number, &one, &info);
}

/// The lower triangle at `a`, inverted in place. Halves, since OpenBLAS inverts blocks by products of
/// vectors.
void invert_triangle(double* a, int n, int stride) {
  constexpr int kSmall = 32;
  if (n <= kSmall) {
    int info = 0;
    dtrtri_("L", "N", &n, a, &stride, &info);
    if (info != 0) throw std::runtime_error("inverse_from_cholesky: singular factor");
    return;
  }
  const int half = n / 2, rest = n - half;
  const double one = 1.0, minus = -1.0;
  double* below = a + half;
  double* last = below + static_cast<std::ptrdiff_t>(half) * stride;
  invert_triangle(a, half, stride);
  invert_triangle(last, rest, stride);
  dtrmm_("L", "L", "N", "N", &rest, &half, &minus, last, &stride, below, &stride);
  dtrmm_("R", "L", "N", "N", &rest, &half, &one, a, &stride, below, &stride);
}

constexpr double kDependent = 1e-13;  // eigenvalue of R^T R, of the largest: (3e-7)^2

/// `result.vectors` holds the matrix.
void decompose(const char* job, SymmetricEigen& result) {
  use_single_threaded_blas();
  const int n = static_cast<int>(result.vectors.rows());
  if (n == 0) return;
  if (!result.vectors.allFinite()) {
    result.values.setConstant(std::numeric_limits<double>::quiet_NaN());
    result.vectors.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  int info = 0, query = -1, integer_size = 0;
  double size = 0.0;
  const BlasCall call;
  dsyevd_(job, "U", &n, result.vectors.data(), &n, result.values.data(), &size, &query, &integer_size, &query,
          &info);
  const int work_size = static_cast<int>(size);
  std::vector<double> work(static_cast<std::size_t>(work_size));
  std::vector<int> integers(static_cast<std::size_t>(integer_size));
  dsyevd_(job, "U", &n, result.vectors.data(), &n, result.values.data(), work.data(), &work_size,
          integers.data(), &integer_size, &info);
  if (info != 0) throw std::runtime_error("eigen_decomposition did not converge");
}

}  // namespace

void use_single_threaded_blas() {
  static const bool done = [] {
    using SetThreads = void (*)(int);
    const auto set_threads = reinterpret_cast<SetThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
    if (set_threads != nullptr) set_threads(1);
    if (memory_is_limited()) fetch_buffer();
    return true;
  }();
  static_cast<void>(done);
}

std::optional<Eigen::MatrixXd> cholesky_lower(const Eigen::MatrixXd& symmetric) {
  use_single_threaded_blas();
  const int n = static_cast<int>(symmetric.rows());
  if (n == 0) return Eigen::MatrixXd(0, 0);
  Eigen::MatrixXd upper = symmetric;
  int info = 0;
  {
    const BlasCall call;
    dpotrf_("U", &n, upper.data(), &n, &info);
  }
  if (info != 0) return std::nullopt;
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(n, n);
  lower.triangularView<Eigen::Lower>() = upper.transpose();
  if (!lower.diagonal().allFinite()) return std::nullopt;
  return lower;
}

Eigen::MatrixXd inverse_from_cholesky(const Eigen::MatrixXd& lower) {
  use_single_threaded_blas();
  const int n = static_cast<int>(lower.rows());
  if (n == 0) return Eigen::MatrixXd(0, 0);
  Eigen::MatrixXd inverse = lower;
  int info = 0;
  {
    const BlasCall call;
    invert_triangle(inverse.data(), n, n);
    dlauum_("L", &n, inverse.data(), &n, &info);
  }
  inverse.triangularView<Eigen::StrictlyUpper>() = inverse.transpose();
  return inverse;
}

double log_determinant(const Eigen::MatrixXd& lower) { return 2.0 * lower.diagonal().array().log().sum(); }

SymmetricEigen eigen_decomposition(const Eigen::MatrixXd& symmetric) {
  SymmetricEigen result{Eigen::VectorXd(symmetric.rows()), symmetric};
  decompose("V", result);
  return result;
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric) {
  SymmetricEigen result{Eigen::VectorXd(symmetric.rows()), symmetric};
  decompose("N", result);
  return result.values;
}

PrecisionInverse invert_precision(const Eigen::MatrixXd& precision) {
  if (const auto lower = cholesky_lower(precision))
    return {inverse_from_cholesky(*lower), log_determinant(*lower)};
  if (!(precision.diagonal().array() > 0.0).all())
    throw std::runtime_error("invert_precision: the diagonal is not positive");
  const Eigen::VectorXd scale = precision.diagonal().cwiseSqrt().cwiseInverse();
  SymmetricEigen eigen = eigen_decomposition(scale.asDiagonal() * precision * scale.asDiagonal());
  const double floor = static_cast<double>(precision.rows()) * std::numeric_limits<double>::epsilon();
  eigen.values = eigen.values.cwiseMax(floor);
  const Eigen::MatrixXd root =
      scale.asDiagonal() * eigen.vectors * eigen.values.cwiseSqrt().cwiseInverse().asDiagonal();
  return {root * root.transpose(), eigen.values.array().log().sum() - 2.0 * scale.array().log().sum()};
}

LeastSquares least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double threshold) {
  use_single_threaded_blas();
  const int m = static_cast<int>(a.rows()), n = static_cast<int>(a.cols()), one = 1, query = -1;
  LeastSquares result{Eigen::VectorXd::Zero(n), 0};
  if (m == 0 || n == 0) return result;
  if (!a.allFinite() || !b.allFinite()) {
    result.solution.setConstant(std::numeric_limits<double>::quiet_NaN());
    return result;
  }
  Eigen::MatrixXd factors = a;
  const int rows = std::max(m, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(rows);
  right.head(m) = b;
  std::vector<int> pivots(static_cast<std::size_t>(n), 0);
  int info = 0;
  double size = 0.0;
  const BlasCall call;
  dgelsy_(&m, &n, &one, factors.data(), &m, right.data(), &rows, pivots.data(), &threshold, &result.rank,
          &size, &query, &info);
  const int work_size = static_cast<int>(size);
  std::vector<double> work(static_cast<std::size_t>(work_size));
  dgelsy_(&m, &n, &one, factors.data(), &m, right.data(), &rows, pivots.data(), &threshold, &result.rank,
          work.data(), &work_size, &info);
  result.solution = right.head(n);
  return result;
}

Eigen::MatrixXd null_space(const Eigen::MatrixXd& rows) {
  if (rows.cols() == 0) return Eigen::MatrixXd(0, 0);
  const SymmetricEigen eigen = eigen_decomposition(rows.transpose() * rows);
  const double dependent = kDependent * std::max(0.0, eigen.values.tail(1).sum());
  return eigen.vectors.leftCols((eigen.values.array() <= dependent).count());
}

void add_outer_product_upper(const double* a, int n, int k, Eigen::MatrixXd& c) {
  const double one = 1.0;
  const int ldc = static_cast<int>(c.rows());
  if (n == 0) return;
  const BlasCall call;
  dsyrk_("U", "N", &n, &k, &one, a, &n, &one, c.data(), &ldc);
}

Eigen::MatrixXd product(const Eigen::Ref<const Eigen::MatrixXd>& a,
                        const Eigen::Ref<const Eigen::MatrixXd>& b) {
  const double one = 1.0, zero = 0.0;
  const int m = static_cast<int>(a.rows()), n = static_cast<int>(b.cols()), k = static_cast<int>(a.cols());
  const int lda = static_cast<int>(a.outerStride()), ldb = static_cast<int>(b.outerStride());
  if (m == 0 || n == 0 || k == 0) return Eigen::MatrixXd::Zero(m, n);
  Eigen::MatrixXd c(m, n);
  const BlasCall call;
  dgemm_("N", "N", &m, &n, &k, &one, a.data(), &lda, b.data(), &ldb, &zero, c.data(), &m);
  return c;
}

namespace {

/// `c` += A^T B, dense columns of A's width.
void add_transposed_product_to(double* c, const Eigen::Ref<const Eigen::MatrixXd>& a,
                               const Eigen::Ref<const Eigen::MatrixXd>& b) {
  const double one = 1.0;
  const int m = static_cast<int>(a.cols()), n = static_cast<int>(b.cols()), k = static_cast<int>(a.rows());
  const int lda = static_cast<int>(a.outerStride()), ldb = static_cast<int>(b.outerStride());
  if (m == 0 || n == 0 || k == 0) return;
  const BlasCall call;
  dgemm_("T", "N", &m, &n, &k, &one, a.data(), &lda, b.data(), &ldb, &one, c, &m);
}

}  // namespace

void add_transposed_product(const Eigen::Ref<const Eigen::MatrixXd>& a,
                            const Eigen::Ref<const Eigen::MatrixXd>& b, Eigen::MatrixXd& c) {
  add_transposed_product_to(c.data(), a, b);
}

Eigen::MatrixXd upper_factor(Eigen::MatrixXd a) {
  use_single_threaded_blas();
  const int m = static_cast<int>(a.rows()), n = static_cast<int>(a.cols());
  const Eigen::Index height = std::min(a.rows(), a.cols());
  if (height == 0) return a.topRows(height);
  Eigen::VectorXd reflectors(height);
  int info = 0, query = -1;
  double size = 0.0;
  const BlasCall call;
  dgeqrf_(&m, &n, a.data(), &m, reflectors.data(), &size, &query, &info);
  const int work_size = static_cast<int>(size);
  Eigen::VectorXd work(work_size);
  dgeqrf_(&m, &n, a.data(), &m, reflectors.data(), work.data(), &work_size, &info);
  return a.topRows(height).triangularView<Eigen::Upper>();
}

void add_transposed_product_upper(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::MatrixXd& r,
                                  Eigen::MatrixXd& c) {
  constexpr Eigen::Index kTogether = 48;  // columns that are taken to be as long as the last of them
  for (Eigen::Index column = 0; column < r.cols();) {
    const Eigen::Index left = r.cols() - column;
    const Eigen::Index count = column >= r.rows() ? left : std::min(kTogether, left);
    const Eigen::Index height = std::min(r.rows(), column + count);
    add_transposed_product_to(c.col(column).data(), a.topRows(height), r.block(0, column, height, count));
    column += count;
  }
}

void add_gram_upper(const Eigen::Ref<const Eigen::MatrixXd>& a, double factor, Eigen::MatrixXd& c) {
  const double one = 1.0;
  const int n = static_cast<int>(a.cols()), k = static_cast<int>(a.rows());
  const int lda = static_cast<int>(a.outerStride());
  if (n == 0 || k == 0) return;
  const BlasCall call;
  dsyrk_("U", "T", &n, &k, &factor, a.data(), &lda, &one, c.data(), &n);
}

void solve_lower(const Eigen::MatrixXd& lower, Eigen::MatrixXd& b) {
  const double one = 1.0;
  const int m = static_cast<int>(b.rows()), n = static_cast<int>(b.cols());
  if (m == 0 || n == 0) return;
  const BlasCall call;
  dtrsm_("L", "L", "N", "N", &m, &n, &one, lower.data(), &m, b.data(), &m);
}

Eigen::MatrixXd solve_positive_definite(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const std::optional<Eigen::MatrixXd> lower = cholesky_lower(a);
  if (!lower) throw std::runtime_error("solve_positive_definite: the matrix is not positive definite");
  const int n = static_cast<int>(b.rows()), columns = static_cast<int>(b.cols());
  Eigen::MatrixXd solution = b;
  int info = 0;
  const BlasCall call;
  if (n > 0 && columns > 0) dpotrs_("L", &n, &columns, lower->data(), &n, solution.data(), &n, &info);
  return solution;
}

void symmetrise_from_upper(Eigen::MatrixXd& matrix) {
  matrix.triangularView<Eigen::StrictlyLower>() = matrix.transpose();
}

}  // namespace volcal
