#include "volcal/identify/statistics/quadratic_form.h"

#include <cmath>

#include "volcal/identify/statistics/chi_squared.h"

namespace volcal {
namespace {

constexpr double kNearTheMean = 1e-4;  // of the mean: there the formula is 0/0

/// log10 P(Z > x).
double log10_normal_exceedance(double x) {
  const double log10_two_sided = log10_chi_squared_exceedance(x * x, 1.0);
  if (x >= 0.0) return log10_two_sided - std::log10(2.0);
  return std::log10(1.0 - 0.5 * std::pow(10.0, log10_two_sided));
}

}  // namespace

double log10_quadratic_form_exceedance(double q, const Eigen::VectorXd& weights) {
  const double largest = weights.size() > 0 ? weights.maxCoeff() : 0.0;
  if (!(q > 0.0)) return 0.0;
  if (!(largest > 0.0)) return -std::numeric_limits<double>::infinity();
  const Eigen::ArrayXd w = weights.array() / largest;
  const double x = q / largest, mean = w.sum();
  if (std::abs(x - mean) < kNearTheMean * mean) {
    const double squares = w.square().sum();
    return log10_chi_squared_exceedance(x * mean / squares, mean * mean / squares);
  }
  const auto slope = [&](double t) { return (w / (1.0 - 2.0 * t * w)).sum(); };
  double low = x > mean ? 0.0 : -1.0, high = x > mean ? 0.5 : 0.0;
  while (slope(low) > x) low *= 2.0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (slope(middle) < x ? low : high) = middle;
  }
  const double t = 0.5 * (low + high);
  const Eigen::ArrayXd rest = 1.0 - 2.0 * t * w;
  const double cumulant = -0.5 * rest.log().sum();
  const double root = std::copysign(std::sqrt(2.0 * (t * x - cumulant)), t);
  const double scaled = t * std::sqrt((2.0 * (w / rest).square()).sum());
  return log10_normal_exceedance(root + std::log(scaled / root) / root);
}

}  // namespace volcal
