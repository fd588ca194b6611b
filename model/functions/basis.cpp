#include "volcal/model/functions/basis.h"

#include <array>

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
  for_each_quadrature_point(basis, [&](double q, double weight) {
    const Eigen::VectorXd row = basis.row(q);
    result.zeroth += weight * row;
    result.first += weight * q * row;
  });
  return result;
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
