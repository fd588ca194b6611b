#include <array>
#include <stdexcept>

#include "volcal/model/functions/legendre_polynomials.h"
#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

constexpr int kMaxLegendreDegree = 30;

/// Legendre polynomials P_0 .. P_n of t, where t runs from -1 to 1 over the travel.
class Legendre final : public Basis {
 public:
  Legendre(int degree, double travel_min, double travel_max)
      : degree_(degree), travel_min_(travel_min), travel_max_(travel_max) {}

  int size() const override { return degree_ + 1; }
  int support() const override { return degree_ + 1; }
  std::vector<double> pieces() const override { return {travel_min_, travel_max_}; }
  std::optional<int> degree() const override { return degree_; }
  int quadrature_order() const override { return degree_ + 1; }
  int roughness_order() const override { return 0; }

  int evaluate(double q, int order, double* values) const override {
    const double slope = 2.0 / (travel_max_ - travel_min_);
    const double t = (q - travel_min_) * slope - 1.0;
    write_legendre_polynomials(degree_, t, values);
    for (int k = 0; k < order; ++k) differentiate(slope, values);
    return 0;
  }

 private:
  /// Replaces the values by those of the next derivative: P'_n = P'_(n-2) + (2n - 1) P_(n-1), which holds for
  /// any derivative of both sides.
  void differentiate(double slope, double* p) const {
    std::array<double, kMaxLegendreDegree + 1> lower;
    for (int n = 0; n <= degree_; ++n) lower[static_cast<std::size_t>(n)] = p[n];
    p[0] = 0.0;
    if (degree_ > 0) p[1] = slope * lower[0];
    for (int n = 2; n <= degree_; ++n) {
      p[n] = p[n - 2] + (2 * n - 1) * slope * lower[static_cast<std::size_t>(n) - 1];
    }
  }

  int degree_;
  double travel_min_;
  double travel_max_;
};

std::unique_ptr<Basis> make_legendre(const FunctionSpec& spec, const Axis& axis) {
  if (spec.degree < 1 || spec.degree > kMaxLegendreDegree) {
    throw std::invalid_argument("degree of a Legendre series must be 1 to 30");
  }
  return std::make_unique<Legendre>(spec.degree, axis.travel_min, axis.travel_max);
}

}  // namespace

extern const BasisKind kLegendreBasis = {
    .name = "legendre",
    .summary = "Legendre polynomials of degree 0 to `degree`, scaled to the travel",
    .source = "M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 1964, ch. 22",
    .degree_min = 1,
    .degree_max = kMaxLegendreDegree,
    .linear_axes = true,
    .rotary_axes = true,
    .uses_knots = false,
    .make = make_legendre,
};

}  // namespace volcal
