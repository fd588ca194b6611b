#include "volcal/model/functions/gauss_legendre.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace volcal {
namespace {

struct LegendreValue {
  double value;
  double derivative;
};

LegendreValue legendre(int n, double x) {
  double previous = 1.0;
  double current = x;
  for (int k = 2; k <= n; ++k) {
    const double next = ((2 * k - 1) * x * current - (k - 1) * previous) / k;
    previous = current;
    current = next;
  }
  return {current, n * (x * current - previous) / (x * x - 1.0)};
}

double legendre_root(int n, int index) {
  double x = -std::cos(std::numbers::pi * (index + 0.75) / (n + 0.5));
  for (int iteration = 0; iteration < 20; ++iteration) {
    const LegendreValue p = legendre(n, x);
    const double step = p.value / p.derivative;
    x -= step;
    if (std::abs(step) < 1e-16) break;
  }
  return x;
}

}  // namespace

GaussLegendre gauss_legendre(int n) {
  if (n < 1) throw std::invalid_argument("a quadrature rule needs at least one point");
  GaussLegendre rule;
  for (int i = 0; i < n; ++i) {
    const double x = 2 * i + 1 == n ? 0.0 : legendre_root(n, i);
    const double derivative = legendre(n, x).derivative;
    rule.points.push_back(x);
    rule.weights.push_back(2.0 / ((1.0 - x * x) * derivative * derivative));
  }
  return rule;
}

}  // namespace volcal
