#include <cmath>
#include <numbers>
#include <stdexcept>

#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

constexpr int kMaxHarmonic = 30;

/// 1, cos q, sin q, cos 2q, sin 2q, ... up to a highest harmonic.
class Fourier final : public Basis {
 public:
  Fourier(int harmonics, double travel_min, double travel_max)
      : harmonics_(harmonics), travel_min_(travel_min), travel_max_(travel_max) {}

  int size() const override { return 2 * harmonics_ + 1; }
  int support() const override { return size(); }
  int roughness_order() const override { return 0; }
  int harmonics() const override { return harmonics_; }

  /// A piece holds at most half a wave of the product of the two highest harmonics; on it 16 points
  /// integrate to rounding.
  std::vector<double> pieces() const override {
    const double longest = std::numbers::pi / (2.0 * harmonics_);
    const int count = static_cast<int>(std::ceil((travel_max_ - travel_min_) / longest));
    std::vector<double> ends;
    ends.reserve(static_cast<std::size_t>(count) + 1);
    for (int i = 0; i < count; ++i) ends.push_back(travel_min_ + (travel_max_ - travel_min_) * i / count);
    ends.push_back(travel_max_);
    return ends;
  }
  int quadrature_order() const override { return 16; }

  int evaluate(double q, int order, double* values) const override {
    values[0] = order == 0 ? 1.0 : 0.0;
    double* pair = values + 1;
    const double c1 = std::cos(q);
    const double s1 = std::sin(q);
    double c = 1.0;
    double s = 0.0;
    for (int k = 1; k <= harmonics_; ++k) {
      const double next = c * c1 - s * s1;
      s = s * c1 + c * s1;
      c = next;
      write_derivative(k, c, s, order, pair);
      pair += 2;
    }
    return 0;
  }

 private:
  /// Derivative of cos kq and sin kq: k^order times the pair turned by order quarter turns.
  static void write_derivative(int k, double c, double s, int order, double* pair) {
    for (int i = 0; i < order; ++i) {
      const double turned = -k * s;
      s = k * c;
      c = turned;
    }
    pair[0] = c;
    pair[1] = s;
  }

  int harmonics_;
  double travel_min_;
  double travel_max_;
};

std::unique_ptr<Basis> make_fourier(const FunctionSpec& spec, const Axis& axis) {
  if (spec.degree < 1 || spec.degree > kMaxHarmonic) {
    throw std::invalid_argument("highest harmonic of a Fourier series must be 1 to 30");
  }
  if (!is_rotary(axis.name)) throw std::invalid_argument("a Fourier series is for rotary axes");
  return std::make_unique<Fourier>(spec.degree, axis.travel_min, axis.travel_max);
}

}  // namespace

extern const BasisKind kFourierBasis = {
    .name = "fourier",
    .summary =
        "1, cos kq, sin kq for k = 1 to `degree`, for rotary axes; \"auto\": as many as the readings tell "
        "apart",
    .source = "M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 1964, ch. 4",
    .degree_min = 1,
    .degree_max = kMaxHarmonic,
    .linear_axes = false,
    .rotary_axes = true,
    .uses_knots = false,
    .has_automatic_degree = true,
    .is_periodic = true,
    .make = make_fourier,
};

}  // namespace volcal
