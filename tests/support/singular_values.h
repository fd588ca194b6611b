#pragma once
/// Singular values by LAPACK, largest first: decompositions of Eigen are compiled anew in every file.

#include <Eigen/Core>
#include <algorithm>
#include <stdexcept>

extern "C" void dgesvd_(const char* left, const char* right, const int* rows, const int* columns, double* a,
                        const int* leading, double* values, double* u, const int* leading_u, double* vt,
                        const int* leading_vt, double* work, const int* work_size, int* info);

namespace volcal::testing {

inline Eigen::VectorXd singular_values(Eigen::MatrixXd matrix) {
  const int rows = static_cast<int>(matrix.rows()), columns = static_cast<int>(matrix.cols()), one = 1;
  Eigen::VectorXd values(std::min(rows, columns));
  Eigen::VectorXd work(10 * (rows + columns));
  const int work_size = static_cast<int>(work.size());
  int info = 0;
  dgesvd_("N", "N", &rows, &columns, matrix.data(), &rows, values.data(), nullptr, &one, nullptr, &one,
          work.data(), &work_size, &info);
  if (info != 0) throw std::runtime_error("dgesvd does not converge");
  return values;
}

}  // namespace volcal::testing
