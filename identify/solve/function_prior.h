#pragma once
/// Gaussian-process priors for error functions with `knots = "auto"`: how an error function may look before
/// any reading is seen. Covariance of f between positions a and b, for unit amplitude and correlation length
/// l,
///   k(a, b) = shape(|a - b| / l) + 10^4 (1 + (a - home)(b - home) / L^2),
/// shape = squared exponential or Matern 5/2 (Rasmussen and Williams 2006, eq. 4.9 and 4.17), or, not
/// stationary, a cubic spline of L / l equal pieces with independent coefficients; the second term leaves
/// constant and straight parts nearly free. It is projected on the basis by least squares and conditioned on
/// the datum (Z of datum.h).

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "volcal/model/description/machine.h"
#include "volcal/model/functions/basis.h"

namespace volcal {

enum class Roughness { SquaredExponential, Matern52 };

struct PriorShape {
  Roughness roughness = Roughness::SquaredExponential;
  double length = 0.0;           ///< correlation length, share of the travel
  Eigen::MatrixXd precision;     ///< unit amplitude, reduced coordinates
  Eigen::MatrixXd inverse_root;  ///< R^-1 with precision = R^T R
  double log_determinant = 0.0;  ///< of `precision`
};

/// All shapes that evidence chooses from, for one basis and datum.
std::vector<PriorShape> prior_shapes(const Basis& basis, const Axis& axis,
                                     const Eigen::MatrixXd& datum_basis);

/// What all other parameters and the readings say about one function: log likelihood -1/2 z^T Q z + h^T z.
struct FunctionEvidence {
  Eigen::MatrixXd precision;   ///< Q
  Eigen::VectorXd right_side;  ///< h
};

struct ShapeChoice {
  double lambda = 0.0;  ///< 1 / amplitude^2 of highest evidence
  double log_evidence = 0.0;
};
/// Best amplitude of every shape, by the evidence
///   log E = 1/2 log det(lambda S) - 1/2 log det(Q + lambda S) + 1/2 h^T (Q + lambda S)^-1 h.
std::vector<ShapeChoice> best_amplitudes(const std::vector<PriorShape>& shapes,
                                         const FunctionEvidence& evidence, double smallest_amplitude,
                                         double largest_amplitude);

}  // namespace volcal
