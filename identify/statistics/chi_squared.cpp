#include "volcal/identify/statistics/chi_squared.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/SpecialFunctions>

#include "volcal/identify/statistics/log_gamma.h"

namespace volcal {
namespace {

constexpr double kSmallest = 1e-290;  // below, a probability is lost

constexpr double kFarOut = 200.0;     // exponent below which the probability itself may underflow
constexpr double kManyDegrees = 1e6;  // of freedom: an estimated variance is as good as a known one

/// log of Gamma(a, x) / Gamma(a) for x > a + 1 by Legendre's continued fraction (Abramowitz and Stegun
/// 6.5.31), Lentz's algorithm.
double log_upper_gamma(double a, double x) {
  constexpr double kTiny = 1e-300;
  double b = x + 1.0 - a;
  double c = 1.0 / kTiny;
  double d = 1.0 / b;
  double h = d;
  for (int i = 1; i < 1000; ++i) {
    const double an = -i * (i - a);
    b += 2.0;
    d = an * d + b;
    if (std::abs(d) < kTiny) d = kTiny;
    c = b + an / c;
    if (std::abs(c) < kTiny) c = kTiny;
    d = 1.0 / d;
    const double factor = d * c;
    h *= factor;
    if (std::abs(factor - 1.0) < 1e-15) break;
  }
  return a * std::log(x) - x - log_gamma(a) + std::log(h);
}

/// Poisson mixture of central distributions (Johnson, Kotz and Balakrishnan 1995, Continuous Univariate
/// Distributions 2, 29.3).
double noncentral_exceedance(double chi2, double dof, double noncentrality) {
  const double mean = 0.5 * noncentrality;
  const int last = static_cast<int>(mean + 12.0 * std::sqrt(mean + 1.0)) + 20;
  double sum = 0.0;
  for (int j = 0; j <= last; ++j) {
    const double log_weight =
        (j > 0 ? j * std::log(std::max(mean, 1e-300)) : 0.0) - mean - log_gamma(j + 1.0);
    sum += std::exp(log_weight) * chi_squared_exceedance(chi2, dof + 2.0 * j);
  }
  return sum;
}

/// Root of a falling function between two abscissae that enclose it.
template <class Function>
double root_of_falling(double low, double high, const Function& function) {
  for (int i = 0; i < 200 && high - low > 1e-12 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (function(middle) > 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double chi_squared_exceedance(double chi2, double dof) {
  if (chi2 <= 0.0) return 1.0;
  return Eigen::numext::igammac(dof / 2.0, chi2 / 2.0);
}

double log10_chi_squared_exceedance(double chi2, double dof) {
  if (!(chi2 > 0.0)) return 0.0;
  if (chi2 < kFarOut || chi2 < 2.0 * dof) return std::log10(chi_squared_exceedance(chi2, dof));
  return log_upper_gamma(dof / 2.0, chi2 / 2.0) / std::log(10.0);
}

double exceedance_of_estimated(double chi2, double dof, double freedom) {
  if (!(chi2 > 0.0)) return 1.0;
  if (!(freedom < kManyDegrees)) return chi_squared_exceedance(chi2, dof);
  return Eigen::numext::betainc(freedom / 2.0, dof / 2.0, freedom / (freedom + chi2));
}

double log10_exceedance_of_estimated(double chi2, double dof, double freedom) {
  if (!(freedom < kManyDegrees)) return log10_chi_squared_exceedance(chi2, dof);
  const double p = exceedance_of_estimated(chi2, dof, freedom);
  if (p > kSmallest) return std::log10(p);
  const double a = freedom / 2.0, b = dof / 2.0, x = freedom / (freedom + chi2);
  const double log_beta = log_gamma(a) + log_gamma(b) - log_gamma(a + b);
  return (a * std::log(x) + b * std::log1p(-x) - std::log(a) - log_beta) / std::log(10.0);
}

double chi_squared_quantile(double log10_probability, double dof) {
  const auto excess = [&](double chi2) {
    return log10_chi_squared_exceedance(chi2, dof) - log10_probability;
  };
  double high = dof + 1.0;
  while (excess(high) > 0.0) high *= 2.0;
  return root_of_falling(0.0, high, excess);
}

double detectable_noncentrality(double log10_level, double dof, double power) {
  const double critical = chi_squared_quantile(log10_level, dof);
  const auto missed_power = [&](double noncentrality) {
    return power - noncentral_exceedance(critical, dof, noncentrality);
  };
  double high = critical + 10.0;
  while (missed_power(high) > 0.0) high *= 2.0;
  return root_of_falling(0.0, high, missed_power);
}

}  // namespace volcal
