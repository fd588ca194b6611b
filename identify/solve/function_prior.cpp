#include "volcal/identify/solve/function_prior.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <limits>

namespace volcal {
namespace {

constexpr std::array<double, 7> kLengths = {0.06, 0.1, 0.15, 0.22, 0.32, 0.46, 0.7};  // share of the travel
constexpr double kStraightVariance = 1e4;  // of constant and slope, unit amplitude 1
constexpr double kNugget = 1e-9;           // keeps the covariance of smooth shapes invertible
constexpr int kPointsPerPiece = 4;
constexpr int kAmplitudeSteps = 40;

double correlation(Roughness roughness, double distance) {
  if (roughness == Roughness::SquaredExponential) return std::exp(-0.5 * distance * distance);
  const double s = std::sqrt(5.0) * distance;
  return (1.0 + s + s * s / 3.0) * std::exp(-s);
}

Eigen::VectorXd collocation_points(const Basis& basis) {
  const std::vector<double> pieces = basis.pieces();
  Eigen::VectorXd points(static_cast<Eigen::Index>(pieces.size() - 1) * kPointsPerPiece);
  Eigen::Index next = 0;
  for (std::size_t i = 0; i + 1 < pieces.size(); ++i) {
    for (int k = 0; k < kPointsPerPiece; ++k) {
      points[next++] = pieces[i] + (pieces[i + 1] - pieces[i]) * (k + 0.5) / kPointsPerPiece;
    }
  }
  return points;
}

/// Coefficients of the least-squares fit to values at the points, as a matrix.
Eigen::MatrixXd projection(const Basis& basis, const Eigen::VectorXd& points) {
  Eigen::MatrixXd values(points.size(), basis.size());
  for (Eigen::Index i = 0; i < points.size(); ++i) values.row(i) = basis.row(points[i]).transpose();
  return (values.transpose() * values).ldlt().solve(values.transpose());
}

/// Covariance of the shape alone between the points, unit amplitude.
Eigen::MatrixXd stationary(Roughness roughness, double length, const Eigen::VectorXd& points,
                           const Axis& axis) {
  Eigen::MatrixXd covariance(points.size(), points.size());
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    for (Eigen::Index j = 0; j < points.size(); ++j) {
      covariance(i, j) = correlation(roughness, std::abs(points[i] - points[j]) / (length * axis.travel()));
    }
  }
  return covariance;
}

PriorShape conditioned(Roughness roughness, double length, Eigen::MatrixXd covariance,
                       const Eigen::VectorXd& points, const Eigen::MatrixXd& project, const Axis& axis,
                       const Eigen::MatrixXd& datum_basis) {
  const Eigen::VectorXd scaled = (points.array() - axis.home) / axis.travel();
  covariance.array() += kStraightVariance;
  covariance += kStraightVariance * scaled * scaled.transpose();
  covariance.diagonal().array() += kNugget * kPointsPerPiece;
  const Eigen::MatrixXd of_coefficients = project * covariance * project.transpose();
  PriorShape shape{roughness, length, {}, {}, 0.0};
  const Eigen::MatrixXd precision = datum_basis.transpose() * of_coefficients.ldlt().solve(datum_basis);
  shape.precision = 0.5 * (precision + precision.transpose());
  const Eigen::LLT<Eigen::MatrixXd> root(shape.precision);
  shape.inverse_root = root.matrixU().solve(Eigen::MatrixXd::Identity(precision.rows(), precision.cols()));
  shape.log_determinant = 2.0 * root.matrixLLT().diagonal().array().log().sum();
  return shape;
}

/// One shape's evidence as a function of lambda, in the eigenbasis of Q relative to S.
class ShapeEvidence {
 public:
  ShapeEvidence(const PriorShape& shape, const FunctionEvidence& evidence) {
    const Eigen::MatrixXd relative = shape.inverse_root.transpose() * evidence.precision * shape.inverse_root;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(relative);
    precision_ = eigen.eigenvalues().cwiseMax(0.0);
    squares_ = (eigen.eigenvectors().transpose() * (shape.inverse_root.transpose() * evidence.right_side))
                   .array()
                   .square();
  }

  double operator()(double lambda) const {
    const Eigen::ArrayXd total = precision_.array() + lambda;
    return 0.5 * ((lambda / total).log() + squares_ / total).sum();
  }

 private:
  Eigen::VectorXd precision_;
  Eigen::ArrayXd squares_;
};

}  // namespace

std::vector<PriorShape> prior_shapes(const Basis& basis, const Axis& axis,
                                     const Eigen::MatrixXd& datum_basis) {
  const Eigen::VectorXd points = collocation_points(basis);
  const Eigen::MatrixXd project = projection(basis, points);
  std::vector<PriorShape> shapes;
  for (const Roughness roughness : {Roughness::SquaredExponential, Roughness::Matern52}) {
    for (const double length : kLengths) {
      shapes.push_back(conditioned(roughness, length, stationary(roughness, length, points, axis), points,
                                   project, axis, datum_basis));
    }
  }
  return shapes;
}

std::vector<ShapeChoice> best_amplitudes(const std::vector<PriorShape>& shapes,
                                         const FunctionEvidence& evidence, double smallest_amplitude,
                                         double largest_amplitude) {
  const double log_low = -2.0 * std::log(largest_amplitude);
  const double log_high = -2.0 * std::log(smallest_amplitude);
  std::vector<ShapeChoice> choices;
  for (const PriorShape& shape : shapes) {
    const ShapeEvidence of_lambda(shape, evidence);
    ShapeChoice best{0.0, -std::numeric_limits<double>::infinity()};
    for (int k = 0; k <= kAmplitudeSteps; ++k) {
      const double lambda = std::exp(log_low + (log_high - log_low) * k / kAmplitudeSteps);
      const double value = of_lambda(lambda);
      if (value > best.log_evidence) best = {lambda, value};
    }
    choices.push_back(best);
  }
  return choices;
}

}  // namespace volcal
