#pragma once
/// Matrices at random that are the same in every run.

#include <Eigen/Core>
#include <random>

namespace volcal::test {

/// Entries even in -1..1.
inline Eigen::MatrixXd random_matrix(std::mt19937_64& generator, Eigen::Index rows, Eigen::Index columns) {
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return entry(generator); });
}

}  // namespace volcal::test
