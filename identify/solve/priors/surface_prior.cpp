#include "volcal/identify/solve/priors/surface_prior.h"

#include <Eigen/QR>
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
constexpr double kHeldWeight = 1e4;  // of what is imitated, in units of the prior: a hundredth of its size
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

namespace {

/// Of a precision P, what acts along the columns I: pull pull^T = P I (I^T P I)^-1 I^T P, by orthogonal
/// columns, so that it is positive semidefinite however near to dependent the columns are; log det of I^T P
/// I.
struct HeldDirections {
  Eigen::MatrixXd pull;
  double log_determinant = 0.0;
};

HeldDirections held_directions(const Eigen::MatrixXd& precision, const Eigen::MatrixXd& columns) {
  const SymmetricEigen eigen = eigen_decomposition(precision);
  const Eigen::VectorXd root = eigen.values.cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd half = root.asDiagonal() * (eigen.vectors.transpose() * columns);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(half);
  const Eigen::MatrixXd orthogonal = qr.householderQ() * Eigen::MatrixXd::Identity(half.rows(), half.cols());
  const Eigen::ArrayXd diagonal = qr.matrixQR().diagonal().cwiseAbs();
  return {eigen.vectors * (root.asDiagonal() * orthogonal), 2.0 * diagonal.log().sum()};
}

}  // namespace

SurfacePriors SurfacePriors::without(const Eigen::MatrixXd& imitated) const {
  SurfacePriors other = *this;
  other.imitated_ = imitated;
  if (imitated.cols() == 0) return other;
  for (auto& shape : other.shapes_) {
    PriorShape held = *shape;
    const HeldDirections directions = held_directions(held.precision, imitated);
    held.precision += kHeldWeight * (directions.pull * directions.pull.transpose());
    held.log_determinant -= directions.log_determinant;
    held.rank -= static_cast<int>(imitated.cols());
    shape = std::make_shared<const PriorShape>(std::move(held));
  }
  return other;
}

namespace {

/// L with L L^T the covariance, whose smallest eigenvalues may be rounding.
Eigen::MatrixXd root_of_covariance(const Eigen::MatrixXd& covariance) {
  if (const auto factor = cholesky_lower(covariance)) return factor->triangularView<Eigen::Lower>();
  const SymmetricEigen eigen = eigen_decomposition(covariance);
  return eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// precision^-1 columns
Eigen::MatrixXd explained_by(const Eigen::MatrixXd& precision, const Eigen::MatrixXd& columns) {
  if (precision.rows() == 0) return columns;
  return invert_precision(precision).covariance * columns;
}

}  // namespace

/// In units of the prior, information M = L^T (own) L that the readings have, and the part that the rest
/// explains, coupling^T rest^-1 coupling: directions of which the rest explains nearly all.
Eigen::MatrixXd imitated_coefficients(const Eigen::MatrixXd& own, const Eigen::MatrixXd& coupling,
                                      const Eigen::MatrixXd& rest, const Eigen::MatrixXd& prior) {
  const Eigen::MatrixXd root = root_of_covariance(prior);
  const SymmetricEigen seen = eigen_decomposition(root.transpose() * own * root);
  const Eigen::Index count = (seen.values.array() > kSeen).count();
  if (count == 0) return Eigen::MatrixXd(own.rows(), 0);
  const Eigen::MatrixXd unit =
      root * seen.vectors.rightCols(count) * seen.values.tail(count).cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd across = coupling * unit;
  const SymmetricEigen share = eigen_decomposition(across.transpose() * explained_by(rest, across));
  const Eigen::Index imitated = (share.values.array() > kImitatedShare).count();
  return unit * share.vectors.rightCols(imitated);
}

Eigen::VectorXd imitated_shares(const Eigen::MatrixXd& own, const Eigen::MatrixXd& coupling,
                                const Eigen::MatrixXd& rest, const Eigen::MatrixXd& functions) {
  const Eigen::MatrixXd across = coupling * functions;
  const Eigen::ArrayXd imitated = across.cwiseProduct(explained_by(rest, across)).colwise().sum();
  const Eigen::ArrayXd seen = functions.cwiseProduct(own * functions).colwise().sum();
  return (seen > 0.0).select(imitated / seen, 1.0);
}

}  // namespace volcal
