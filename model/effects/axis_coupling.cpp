#include <algorithm>
#include <array>

#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

struct Power {
  const char* shape;
  int exponent;
  const char* per;
};
constexpr std::array<Power, 3> kPowers = {
    {{"linear", 1, "per_m"}, {"quadratic", 2, "per_m2"}, {"cubic", 3, "per_m3"}}};

const Power& power_of(const std::string& shape) {
  return *std::ranges::find_if(kPowers, [&](const Power& power) { return shape == power.shape; });
}

const EffectSchema& coupling_schema() {
  static const EffectSchema schema = {
      .kind = "axis-coupling",
      .summary =
          "an error motion of one axis depends on the position of another: ram droop EAY(z), cross table "
          "EBX(y), cantilever z^2 and z^3; counted from the other axis's home",
      .source = "ISO/TR 16907:2015, 7.4.2 (non-rigid behaviour)",
      .keys = joined({{symbol_key("error motion that changes: EAY, EBX ..."),
                       {.key = "axis",
                        .type = KeyType::Text,
                        .required = true,
                        .help = "axis on whose position it depends",
                        .choices = {"Z", "Y", "X"}},
                       {.key = "shape",
                        .type = KeyType::Text,
                        .help = "power of the position (default linear)",
                        .choices = {"linear", "quadratic", "cubic"}}},
                      motion_amplitude_keys({"per_m", "per_m2", "per_m3"},
                                            "change per metre, metre^2 or metre^3 of the other axis")})};
  return schema;
}

class CouplingEffect final : public Effect {
 public:
  explicit CouplingEffect(const EffectTable& table)
      : symbol_(table.symbol()),
        axis_(table.axis("axis")),
        power_(power_of(table.spec.options.text("shape").value_or("linear"))) {
    if (axis_ == symbol_.axis) {
      table.fail(symbol_.name() + " depending on its own axis is the error function itself",
                 "name another axis");
    }
    const std::string driver(1, lower_letter_of(axis_));
    name_ = {"axis-coupling", symbol_.name(), driver, power_.shape};
    amplitudes_.push_back({.label = symbol_.name() + " by " + driver +
                                    (power_.exponent > 1 ? "^" + std::to_string(power_.exponent) : ""),
                           .target = {.kind = TargetKind::Motion, .symbol = symbol_},
                           .key = motion_amplitude_key(symbol_, power_.per),
                           .guess = table.number("amplitude", 0.0)});
  }

  void check(const Campaign& campaign, const SourcePlace& place) const override {
    check_axis(campaign, symbol_.axis, amplitudes_[0].label, place);
    check_axis(campaign, axis_, amplitudes_[0].label, place);
  }

  Eigen::MatrixXd drivers(const SetupView& view, const Eigen::VectorXd& /*shape*/) const override {
    return positions_from_home(view, axis_).array().pow(power_.exponent);
  }

 private:
  ErrorSymbol symbol_;
  AxisName axis_;
  Power power_;
};

class AxisCoupling final : public EffectKind {
 public:
  const EffectSchema& schema() const override { return coupling_schema(); }

  std::unique_ptr<Effect> make(const EffectSpec& spec, const std::string& model_file) const override {
    return std::make_unique<CouplingEffect>(EffectTable(spec, model_file));
  }

  std::vector<EffectSpec> candidates(const Campaign& campaign) const override {
    std::vector<EffectSpec> specs;
    for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
      for (const AxisName axis : linear_axes(campaign.machine)) {
        if (axis == symbol.axis) continue;
        for (const Power& power : kPowers) {
          specs.push_back(effect_spec("axis-coupling", {{"symbol", symbol.name()},
                                                        {"axis", std::string(1, letter_of(axis))},
                                                        {"shape", std::string(power.shape)}}));
        }
      }
    }
    return specs;
  }
};

}  // namespace

const EffectKind& axis_coupling_effect() {
  static const AxisCoupling kind;
  return kind;
}

}  // namespace volcal
