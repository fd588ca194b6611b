#include "volcal/identify/criticism/projection/separation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/numeric/dense.h"

namespace volcal {
namespace {

constexpr double kVisibleEigenvalue = 1e-8;  // of a Gram matrix with unit diagonal
constexpr double kTouches = 1e-6;            // squared component of an amplitude along a direction

Eigen::MatrixXd block(const Eigen::MatrixXd& gram, ColumnRange rows, ColumnRange columns) {
  return gram.block(rows.first, columns.first, rows.count, columns.count);
}

Eigen::VectorXd inverse_root(const Eigen::VectorXd& squares) {
  return squares.unaryExpr([](double square) { return square > 0.0 ? 1.0 / std::sqrt(square) : 0.0; });
}

/// W with W^T G W = 1 on the visible directions of a Gram matrix.
Eigen::MatrixXd orthonormaliser(const Eigen::MatrixXd& gram) {
  const Eigen::VectorXd scale = inverse_root(gram.diagonal());
  const SymmetricEigen eigen = eigen_decomposition(scale.asDiagonal() * gram * scale.asDiagonal());
  const Eigen::VectorXd& values = eigen.values;
  const Eigen::Index visible = (values.array() >= kVisibleEigenvalue).count();
  return scale.asDiagonal() * eigen.vectors.rightCols(visible) *
         values.tail(visible).cwiseSqrt().cwiseInverse().asDiagonal();
}

}  // namespace

void clear_invisible(const Eigen::VectorXd& known_norm, Eigen::MatrixXd& gram) {
  for (Eigen::Index k = 0; k < gram.rows(); ++k) {
    if (gram(k, k) >= kVisibleEigenvalue * known_norm[k] * known_norm[k]) continue;
    gram.row(k).setZero();
    gram.col(k).setZero();
  }
}

Eigen::MatrixXd components_along(const Eigen::MatrixXd& gram, ColumnRange hypothesis) {
  return orthonormaliser(block(gram, hypothesis, hypothesis)).transpose() *
         gram.middleRows(hypothesis.first, hypothesis.count);
}

Eigen::MatrixXd projected_off(const Eigen::MatrixXd& gram, ColumnRange given) {
  if (given.count == 0) return gram;
  const Eigen::MatrixXd onto = components_along(gram, given);
  Eigen::MatrixXd left = gram - onto.transpose() * onto;
  left.middleRows(given.first, given.count).setZero();
  left.middleCols(given.first, given.count).setZero();
  clear_invisible(gram.diagonal().cwiseMax(0.0).cwiseSqrt(), left);
  return left;
}

Eigen::MatrixXd projected_off(const Eigen::MatrixXd& gram, ColumnRange wanted, ColumnRange rival) {
  const Eigen::MatrixXd onto = components_along(gram, rival).middleCols(wanted.first, wanted.count);
  return block(gram, wanted, wanted) - onto.transpose() * onto;
}

double canonical_cosine(const Eigen::MatrixXd& gram, ColumnRange a, ColumnRange b) {
  const Eigen::MatrixXd left = orthonormaliser(block(gram, a, a));
  const Eigen::MatrixXd right = orthonormaliser(block(gram, b, b));
  if (left.cols() == 0 || right.cols() == 0) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::MatrixXd across = left.transpose() * block(gram, a, b) * right;
  return std::min(1.0, std::sqrt(eigenvalues(across.transpose() * across).tail<1>()[0]));
}

Eigen::VectorXd amplitude_uncertainty(const Eigen::MatrixXd& gram, const Eigen::VectorXd& reference) {
  const Eigen::VectorXd scale = inverse_root(reference);
  const SymmetricEigen eigen = eigen_decomposition(scale.asDiagonal() * gram * scale.asDiagonal());
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(gram.rows());
  for (Eigen::Index k = 0; k < gram.rows(); ++k) {
    const double value = eigen.values[k];
    for (Eigen::Index i = 0; i < gram.rows(); ++i) {
      const double share = std::pow(eigen.vectors(i, k), 2);
      if (value >= kThresholds.same_squared_sine) {
        variance[i] += share * scale[i] * scale[i] / value;
      } else if (share > kTouches || scale[i] == 0.0) {
        variance[i] = std::numeric_limits<double>::infinity();
      }
    }
  }
  return variance.cwiseSqrt();
}

Eigen::VectorXd least_separated_amplitude(const Eigen::MatrixXd& own, const Eigen::MatrixXd& apart,
                                          const Eigen::VectorXd& known_norm, double noncentrality) {
  const Eigen::MatrixXd basis = orthonormaliser(own);
  if (basis.cols() == 0) return inverse_root(known_norm.cwiseAbs2()) * std::sqrt(noncentrality);
  const SymmetricEigen eigen = eigen_decomposition(basis.transpose() * apart * basis);
  return basis * eigen.vectors.col(0) * std::sqrt(noncentrality);
}

}  // namespace volcal
