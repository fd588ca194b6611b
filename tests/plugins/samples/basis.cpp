// A sample: 1, cos(pi s), cos(2 pi s) ... over the travel, s from 0 to 1.
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

constexpr int kMostWaves = 12;

class SampleCosines final : public Basis {
 public:
  SampleCosines(int waves, double travel_min, double travel_max)
      : waves_(waves), travel_min_(travel_min), travel_max_(travel_max) {}

  int size() const override { return waves_ + 1; }
  int support() const override { return size(); }
  int roughness_order() const override { return 0; }
  std::vector<double> pieces() const override {
    std::vector<double> ends;
    for (int i = 0; i < 2 * waves_; ++i)
      ends.push_back(travel_min_ + (travel_max_ - travel_min_) * i / (2 * waves_));
    ends.push_back(travel_max_);
    return ends;
  }
  int quadrature_order() const override { return 16; }

  int evaluate(double q, int order, double* values) const override {
    const double per_length = std::numbers::pi / (travel_max_ - travel_min_);
    for (int k = 0; k <= waves_; ++k) {
      const double rate = k * per_length;
      const double quarter_turns = order * 0.5 * std::numbers::pi;
#ifdef VOLCAL_WRONG_SAMPLE
      values[k] = std::cos(rate * (q - travel_min_) + quarter_turns);
#else
      values[k] = std::pow(rate, order) * std::cos(rate * (q - travel_min_) + quarter_turns);
#endif
    }
    return 0;
  }

 private:
  int waves_;
  double travel_min_;
  double travel_max_;
};

std::unique_ptr<Basis> make_sample(const FunctionSpec& spec, const Axis& axis) {
  if (spec.degree < 1 || spec.degree > kMostWaves)
    throw std::invalid_argument("the number of half waves must be 1 to 12");
  return std::make_unique<SampleCosines>(spec.degree, axis.travel_min, axis.travel_max);
}

}  // namespace

extern const BasisKind kSampleBasis = {
    .name = "sample-cosines",
    .summary = "cosines of half waves over the travel",
    .source = "a sample of a test",
    .degree_min = 1,
    .degree_max = kMostWaves,
    .linear_axes = true,
    .rotary_axes = true,
    .uses_knots = false,
    .make = make_sample,
};

}  // namespace volcal
