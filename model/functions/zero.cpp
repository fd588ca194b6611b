#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

/// The space that holds only f = 0: a function switched off.
class Zero final : public Basis {
 public:
  Zero(double travel_min, double travel_max) : travel_min_(travel_min), travel_max_(travel_max) {}

  int size() const override { return 0; }
  int support() const override { return 0; }
  int evaluate(double, int, double*) const override { return 0; }
  std::vector<double> pieces() const override { return {travel_min_, travel_max_}; }
  std::optional<int> degree() const override { return 0; }
  int quadrature_order() const override { return 1; }
  int roughness_order() const override { return 0; }

 private:
  double travel_min_;
  double travel_max_;
};

std::unique_ptr<Basis> make_zero(const FunctionSpec&, const Axis& axis) {
  return std::make_unique<Zero>(axis.travel_min, axis.travel_max);
}

}  // namespace

extern const BasisKind kZeroBasis = {
    .name = "zero",
    .summary = "the function is switched off: left out of the model",
    .source = "reduced models such as the 12-error model of a three-axis machining centre",
    .degree_min = 0,
    .degree_max = 0,
    .linear_axes = true,
    .rotary_axes = true,
    .uses_knots = false,
    .make = make_zero,
};

}  // namespace volcal
