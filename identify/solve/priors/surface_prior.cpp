#include "volcal/identify/solve/priors/surface_prior.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "volcal/identify/numeric/dense.h"

namespace volcal {
namespace {

// Of one variable, and of each of several: shares of the range.
const std::vector<double> kLengthsOfCurve = {0.05, 0.1, 0.2, 0.4, 0.8};
const std::vector<double> kLengthsOfSurface = {0.15, 0.35, 0.8};
constexpr double kNuggetOfCoefficients =
    1e-3;                            // of a coefficient's variance, so that the product can be inverted
constexpr double kHeldWeight = 1e6;  // of what is imitated, in units of the prior
constexpr double kImitatedShare = 0.99;
constexpr double kSeen = 0.01;  // of the prior's information: less, and the readings say nothing

double matern52(double distance, double length) {
  const double s = std::sqrt(5.0) * distance / length;
  return (1.0 + s + s * s / 3.0) * std::exp(-s);
}

/// Of the coefficients of one variable's functions.
Eigen::MatrixXd covariance(const TensorBasis& basis, std::size_t side, double length) {
  const Eigen::VectorXd nodes = basis.nodes(side);
  Eigen::MatrixXd covariance(nodes.size(), nodes.size());
  for (Eigen::Index i = 0; i < nodes.size(); ++i) {
    for (Eigen::Index j = 0; j < nodes.size(); ++j)
      covariance(i, j) = matern52(std::abs(nodes[i] - nodes[j]), length);
  }
  covariance.diagonal().array() += kNuggetOfCoefficients;
  const Eigen::MatrixXd samples = basis.samples(side);
  const double mean_variance =
      (samples * covariance).cwiseProduct(samples).sum() / static_cast<double>(samples.rows());
  return covariance / mean_variance;
}

Eigen::MatrixXd kronecker(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::MatrixXd product(a.rows() * b.rows(), a.cols() * b.cols());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    for (Eigen::Index j = 0; j < a.cols(); ++j)
      product.block(i * b.rows(), j * b.cols(), b.rows(), b.cols()) = a(i, j) * b;
  }
  return product;
}

/// Of one variable at one length.
struct SidePrecision {
  Eigen::MatrixXd precision;
  double log_determinant;
};

SidePrecision side_precision(const TensorBasis& basis, std::size_t side, double length) {
  const PrecisionInverse inverse = invert_precision(covariance(basis, side, length));
  return {inverse.covariance, -inverse.log_determinant};
}

PriorShape with_side(const PriorShape& shape, const SidePrecision& side) {
  PriorShape product = shape;
  const auto before = static_cast<double>(shape.precision.rows()),
             more = static_cast<double>(side.precision.rows());
  product.precision = kronecker(shape.precision, side.precision);
  product.log_determinant = more * shape.log_determinant + before * side.log_determinant;
  product.rank = static_cast<int>(product.precision.rows());
  return product;
}

}  // namespace

SurfacePriors::SurfacePriors(const TensorBasis& basis) {
  const std::size_t variables = basis.sides().size();
  PriorShape nothing;
  nothing.roughness = Roughness::Matern52;
  nothing.precision = Eigen::MatrixXd::Ones(1, 1);
  std::vector<PriorShape> shapes = {nothing};
  for (std::size_t side = 0; side < variables; ++side) {
    lengths_.push_back(variables == 1 ? kLengthsOfCurve : kLengthsOfSurface);
    std::vector<PriorShape> more;
    for (const PriorShape& shape : shapes) {
      for (const double length : lengths_.back()) {
        more.push_back(with_side(shape, side_precision(basis, side, length)));
        more.back().length = length;
      }
    }
    shapes = std::move(more);
  }
  for (PriorShape& shape : shapes) shapes_.push_back(std::make_shared<const PriorShape>(std::move(shape)));
}

std::vector<std::size_t> SurfacePriors::neighbours(std::size_t shape) const {
  std::vector<std::size_t> near;
  std::size_t stride = 1;
  for (std::size_t side = lengths_.size(); side-- > 0;) {
    const std::size_t place = shape / stride % lengths_[side].size();
    if (place > 0) near.push_back(shape - stride);
    if (place + 1 < lengths_[side].size()) near.push_back(shape + stride);
    stride *= lengths_[side].size();
  }
  return near;
}

std::size_t SurfacePriors::middle() const {
  std::size_t shape = 0;
  for (const auto& lengths : lengths_) shape = shape * lengths.size() + lengths.size() / 2;
  return shape;
}

std::vector<double> SurfacePriors::lengths(std::size_t shape) const {
  std::vector<double> lengths(lengths_.size());
  for (std::size_t side = lengths_.size(); side-- > 0; shape /= lengths_[side].size())
    lengths[side] = lengths_[side][shape % lengths_[side].size()];
  return lengths;
}

SurfacePriors SurfacePriors::without(const Eigen::MatrixXd& imitated) const {
  SurfacePriors other = *this;
  other.imitated_ = imitated;
  if (imitated.cols() == 0) return other;
  for (auto& shape : other.shapes_) {
    PriorShape held = *shape;
    const Eigen::MatrixXd pull = held.precision * imitated;
    const PrecisionInverse inner = invert_precision(imitated.transpose() * pull);
    held.precision += kHeldWeight * (pull * inner.covariance * pull.transpose());
    held.log_determinant -= inner.log_determinant;
    held.rank -= static_cast<int>(imitated.cols());
    shape = std::make_shared<const PriorShape>(std::move(held));
  }
  return other;
}

/// In units of the prior, information M = L^T (own) L that the readings have, and the part that the rest
/// explains, coupling^T rest^-1 coupling: directions of which the rest explains nearly all.
Eigen::MatrixXd imitated_coefficients(const Eigen::MatrixXd& own, const Eigen::MatrixXd& coupling,
                                      const Eigen::MatrixXd& rest, const Eigen::MatrixXd& prior) {
  const auto rest_factor = cholesky_lower(rest);
  const auto prior_factor = cholesky_lower(prior);
  if (!rest_factor || !prior_factor)
    throw std::runtime_error("imitated_coefficients: a precision is not positive definite");
  const Eigen::MatrixXd root = prior_factor->triangularView<Eigen::Lower>();
  const SymmetricEigen seen = eigen_decomposition(root.transpose() * own * root);
  const Eigen::Index count = (seen.values.array() > kSeen).count();
  if (count == 0) return Eigen::MatrixXd(own.rows(), 0);
  const Eigen::MatrixXd unit =
      root * seen.vectors.rightCols(count) * seen.values.tail(count).cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd half = rest_factor->triangularView<Eigen::Lower>().solve(coupling * unit);
  const SymmetricEigen share = eigen_decomposition(half.transpose() * half);
  const Eigen::Index imitated = (share.values.array() > kImitatedShare).count();
  return unit * share.vectors.rightCols(imitated);
}

}  // namespace volcal
