#include <algorithm>
#include <array>

#include "volcal/model/effects/formula_effect.h"
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

EffectSchema coupling_schema() {
  return {.kind = "axis-coupling",
          .summary =
              "an error motion of one axis depends on the position of another: ram droop EAY(z), cross table "
              "EBX(y), cantilever z^2 and z^3; counted from the other axis's home",
          .plain =
              "An error motion of one axis changes with the position of another: the machine bends as it "
              "moves, and is not a rigid body.",
          .usual_causes =
              "the weight of a moving column, table or ram on guideways that give way; an unsupported "
              "overhang; levelling or foundation that lets the bed twist; clamps that strain the structure",
          .source = "ISO/TR 16907:2015, 7.4.2 (non-rigid behaviour)",
          .polynomial = true,
          .keys = joined({{symbol_key("error motion that changes: EAY, EBX ..."),
                           axis_key("axis", "axis on whose position it depends"),
                           {.key = "shape",
                            .type = KeyType::Text,
                            .help = "power of the position (default linear)",
                            .choices = {"linear", "quadratic", "cubic"}}},
                          motion_amplitude_keys({"per_m", "per_m2", "per_m3"},
                                                "change per metre, metre^2 or metre^3 of the other axis")})};
}

const Power& power_of(const EffectTable& table, const std::string& shape) {
  for (const Power& power : kPowers) {
    if (shape == power.shape) return power;
  }
  table.fail("\"" + shape + "\" is not a shape", "write linear, quadratic or cubic");
}

std::unique_ptr<FormulaEffect> make_coupling(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  const AxisName axis = table.axis("axis");
  const std::string shape = table.spec.options.text("shape").value_or("linear");
  const Power power = power_of(table, shape);
  if (axis == symbol.axis) {
    table.fail(symbol.name() + " depending on its own axis is the error function itself",
               "name another axis");
  }
  const std::string driver(1, lower_letter_of(axis));
  const std::string label =
      symbol.name() + " by " + driver + (power.exponent > 1 ? "^" + std::to_string(power.exponent) : "");
  return std::make_unique<FormulaEffect>(
      EffectName{"axis-coupling", symbol, position_of(axis), power.shape},
      std::vector{motion_amplitude(table, label, symbol, power.per)},
      [axis, power](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return positions_from_home(view, axis).array().pow(power.exponent);
      },
      [symbol, axis, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
        check_axis(campaign, axis, label, place);
      });
}

std::vector<EffectSpec> couplings(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
    for (const AxisName axis : campaign.machine.linear_axes()) {
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

}  // namespace

const EffectKind& axis_coupling_effect() {
  static const FormulaKind kind(coupling_schema(), make_coupling, couplings);
  return kind;
}

}  // namespace volcal
