#include "volcal/model/functions/basis.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "volcal/model/functions/gauss_legendre.h"

namespace volcal {
namespace {

/// Calls f(q, weight) for every quadrature point of every piece.
template <class F>
void for_each_quadrature_point(const Basis& basis, F f) {
  const GaussLegendre rule = gauss_legendre(basis.quadrature_order());
  const std::vector<double> ends = basis.pieces();
  for (std::size_t piece = 0; piece + 1 < ends.size(); ++piece) {
    const double half = 0.5 * (ends[piece + 1] - ends[piece]);
    const double middle = 0.5 * (ends[piece + 1] + ends[piece]);
    for (std::size_t i = 0; i < rule.points.size(); ++i) {
      f(middle + half * rule.points[i], half * rule.weights[i]);
    }
  }
}

}  // namespace

double Basis::value(double q, const Eigen::Ref<const Eigen::VectorXd>& coefficients) const {
  std::array<double, kMaxBasisSupport> values;
  const int first = evaluate(q, values.data());
  double sum = 0.0;
  for (int i = 0; i < support(); ++i) sum += values[static_cast<std::size_t>(i)] * coefficients[first + i];
  return sum;
}

Eigen::VectorXd Basis::row(double q, int order) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(size());
  std::array<double, kMaxBasisSupport> values;
  const int first = evaluate(q, order, values.data());
  for (int i = 0; i < support(); ++i) all[first + i] = values[static_cast<std::size_t>(i)];
  return all;
}

BasisMoments moments(const Basis& basis) {
  BasisMoments result{Eigen::VectorXd::Zero(basis.size()), Eigen::VectorXd::Zero(basis.size())};
  std::array<double, kMaxBasisSupport> values;
  for_each_quadrature_point(basis, [&](double q, double weight) {
    const int first = basis.evaluate(q, values.data());
    for (int i = 0; i < basis.support(); ++i) {
      result.zeroth[first + i] += weight * values[static_cast<std::size_t>(i)];
      result.first[first + i] += weight * q * values[static_cast<std::size_t>(i)];
    }
  });
  return result;
}

namespace {

/// Row d of column j: the entry (j + d, j) of the Gram matrix.
Eigen::MatrixXd gram_band(const Basis& basis) {
  Eigen::MatrixXd band = Eigen::MatrixXd::Zero(basis.support(), basis.size());
  std::array<double, kMaxBasisSupport> values;
  for_each_quadrature_point(basis, [&](double q, double weight) {
    const int first = basis.evaluate(q, values.data());
    for (int j = 0; j < basis.support(); ++j) {
      for (int i = j; i < basis.support(); ++i)
        band(i - j, first + j) +=
            weight * values[static_cast<std::size_t>(i)] * values[static_cast<std::size_t>(j)];
    }
  });
  return band;
}

/// L of L L^T in the place of the matrix.
void factorize_band(Eigen::MatrixXd& band) {
  const Eigen::Index size = band.cols(), width = band.rows();
  for (Eigen::Index j = 0; j < size; ++j) {
    const Eigen::Index below = std::min(width, size - j);
    band.col(j).head(below) /= std::sqrt(band(0, j));
    for (Eigen::Index k = 1; k < below; ++k)
      band.col(j + k).head(below - k) -= band(k, j) * band.col(j).segment(k, below - k);
  }
}

}  // namespace

Eigen::VectorXd coefficients_with_integrals(const Basis& basis, const Eigen::VectorXd& integrals) {
  Eigen::MatrixXd band = gram_band(basis);
  factorize_band(band);
  const Eigen::Index size = band.cols(), width = band.rows();
  Eigen::VectorXd x = integrals;
  for (Eigen::Index j = 0; j < size; ++j) {
    const Eigen::Index below = std::min(width, size - j) - 1;
    x[j] /= band(0, j);
    x.segment(j + 1, below) -= x[j] * band.col(j).segment(1, below);
  }
  for (Eigen::Index j = size; j-- > 0;) {
    const Eigen::Index below = std::min(width, size - j) - 1;
    x[j] = (x[j] - band.col(j).segment(1, below).dot(x.segment(j + 1, below))) / band(0, j);
  }
  return x;
}

Eigen::MatrixXd gram(const Basis& basis, int order) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(basis.size(), basis.size());
  for_each_quadrature_point(basis, [&](double q, double weight) {
    const Eigen::VectorXd row = basis.row(q, order);
    result += weight * row * row.transpose();
  });
  return result;
}

}  // namespace volcal
