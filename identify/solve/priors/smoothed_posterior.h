#pragma once
/// Posterior of the parameters of a quadratic cost beside the smoothing of some functions and surfaces, and
/// the evidence of their amplitudes (evidence.h).

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "volcal/identify/solve/priors/smoothing.h"

namespace volcal {

inline constexpr double kLeastLambda = 1e4;  ///< amplitudes of 10 mm, the largest
inline constexpr double kMostLambda = 1e18;  ///< of 1 nm: no need to know a straight function better

using Prior = std::shared_ptr<const PriorShape>;

/// Posterior of all parameters, or of some with the others integrated out.
struct Posterior {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd mean;
  double log_evidence = 0.0;
};

/// A quadratic cost about z0 whose smoothing is still missing.
struct Quadratic {
  Eigen::MatrixXd precision;
  Eigen::VectorXd gradient;
  double constant = 0.0;
};

/// A function within a Quadratic's coordinates.
struct Stretch {
  const SmoothingTerm* term;
  int offset;
};

Posterior posterior(const Quadratic& cost, const Eigen::VectorXd& z0, const std::vector<Stretch>& stretches,
                    const std::vector<Prior>& priors, const std::vector<double>& lambda);

/// How many of a function's coefficients the readings settle beside its prior.
double settled_by_readings(const Stretch& stretch, const PriorShape& shape, double lambda,
                           const Posterior& now);

/// MacKay's fixed point.
double updated_lambda(const Stretch& stretch, const PriorShape& shape, double lambda, const Posterior& now);

}  // namespace volcal
