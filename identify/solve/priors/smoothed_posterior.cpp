#include "volcal/identify/solve/priors/smoothed_posterior.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/identify/numeric/dense.h"

namespace volcal {

Posterior posterior(const Quadratic& cost, const Eigen::VectorXd& z0, const std::vector<Stretch>& stretches,
                    const std::vector<Prior>& priors, const std::vector<double>& lambda) {
  Eigen::MatrixXd precision = cost.precision;
  Eigen::VectorXd gradient = cost.gradient;
  double minus_log = cost.constant;
  for (std::size_t t = 0; t < stretches.size(); ++t) {
    const PriorShape& shape = *priors[t];
    const Eigen::Index n = shape.precision.rows();
    const auto z = z0.segment(stretches[t].offset, n);
    const Eigen::VectorXd pull = lambda[t] * (shape.precision * z);
    precision.block(stretches[t].offset, stretches[t].offset, n, n) += lambda[t] * shape.precision;
    gradient.segment(stretches[t].offset, n) += pull;
    minus_log += 0.5 * (z.dot(pull) - shape.log_determinant - shape.rank * std::log(lambda[t]));
  }
  PrecisionInverse inverse = invert_precision(precision);
  Posterior result{std::move(inverse.covariance), {}, 0.0};
  const Eigen::VectorXd step = -(result.covariance * gradient);
  result.mean = z0 + step;
  result.log_evidence = -(minus_log + 0.5 * gradient.dot(step) + 0.5 * inverse.log_determinant);
  return result;
}

double settled_by_readings(const Stretch& stretch, const PriorShape& shape, double lambda,
                           const Posterior& now) {
  const Eigen::Index n = shape.precision.rows();
  const auto covariance = now.covariance.block(stretch.offset, stretch.offset, n, n);
  return shape.rank - lambda * covariance.cwiseProduct(shape.precision).sum();
}

double updated_lambda(const Stretch& stretch, const PriorShape& shape, double lambda, const Posterior& now) {
  const Eigen::Index n = shape.precision.rows();
  const Eigen::VectorXd z = now.mean.segment(stretch.offset, n);
  const double used = settled_by_readings(stretch, shape, lambda, now);
  return std::clamp(std::max(used, 1e-6) / z.dot(shape.precision * z), kLeastLambda, kMostLambda);
}

}  // namespace volcal
