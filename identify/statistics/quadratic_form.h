#pragma once
/// Tail of a weighted sum of independent chi-squared variables with one degree of freedom each.

#include <Eigen/Core>

namespace volcal {

/// log10 P(sum_i w_i z_i^2 > q), z_i standard normal, w_i >= 0, by Lugannani and Rice's saddlepoint formula
/// (Kuonen 1999, Biometrika 86, 929): relative error of the probability of a few per cent, also far out.
double log10_quadratic_form_exceedance(double q, const Eigen::VectorXd& weights);

}  // namespace volcal
