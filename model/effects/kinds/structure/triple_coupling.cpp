// Behaviour that is not rigid, of third degree: an error motion by the product of three positions.
#include <algorithm>
#include <array>
#include <map>

#include "volcal/model/description/variable.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

using Factors = std::array<AxisName, 3>;  // in order, one may be there twice

std::string axes_text(const Factors& factors) {
  std::string text;
  for (const AxisName axis : factors) text += (text.empty() ? "" : " ") + std::string(1, letter_of(axis));
  return text;
}

/// "y z^2".
std::string product_text(const Factors& factors) {
  std::map<AxisName, int> powers;
  for (const AxisName axis : factors) ++powers[axis];
  std::string text;
  for (const auto& [axis, power] : powers) {
    text += (text.empty() ? "" : " ") + std::string(1, lower_letter_of(axis));
    if (power > 1) text += "^" + std::to_string(power);
  }
  return text;
}

EffectDriver driver_of(const Factors& factors) {
  std::vector<Variable> positions;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    if (i == 0 || factors[i] != factors[i - 1]) positions.push_back(position_of(factors[i]));
  }
  return EffectDriver(positions);
}

Factors factors_of(const EffectTable& table) {
  const std::string remedy = "write axes = \"Y Z Z\" for y z^2";
  const std::string text = table.text("axes", remedy);
  std::vector<AxisName> axes;
  for (const std::string& word : words_in(text)) {
    const auto axis = word.size() == 1 ? axis_from_letter(word[0]) : std::nullopt;
    if (!axis) table.fail("\"" + word + "\" is not an axis", remedy);
    axes.push_back(*axis);
  }
  std::ranges::sort(axes);
  if (axes.size() != 3) table.fail("\"" + text + "\" are not three axes", remedy);
  if (axes.front() == axes.back())
    table.fail("its three axes are the same", "use axis-coupling with shape = \"cubic\"");
  return {axes[0], axes[1], axes[2]};
}

/// "x^2 y": shape word of the product, "square" where an axis is there twice.
std::string shape_of(const Factors& factors) {
  if (factors[0] == factors[1]) return "square of the first";
  return factors[1] == factors[2] ? "square of the second" : "product";
}

std::unique_ptr<FormulaEffect> make_triple_coupling(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  const Factors factors = factors_of(table);
  const std::string label = symbol.name() + " by " + product_text(factors);
  return std::make_unique<FormulaEffect>(
      EffectName{"triple-coupling", symbol, driver_of(factors), shape_of(factors)},
      std::vector{motion_amplitude(table, label, symbol, "per_m3")},
      [factors](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        Eigen::VectorXd product = positions_from_home(view, factors[0]);
        product.array() *= positions_from_home(view, factors[1]).array();
        product.array() *= positions_from_home(view, factors[2]).array();
        return product;
      },
      [symbol, factors, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
        for (const AxisName axis : factors) check_axis(campaign, axis, label, place);
      });
}

/// A displacement by a product of positions is the same whichever axis it is said to belong to: it is offered
/// once, under the first.
bool is_offered(ErrorSymbol symbol, const Factors& factors) {
  return is_rotation(symbol.component) || symbol.axis == factors.front();
}

std::vector<EffectSpec> triple_couplings(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  const auto axes = campaign.machine.linear_axes();
  for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
    for (std::size_t i = 0; i < axes.size(); ++i) {
      for (std::size_t j = i; j < axes.size(); ++j) {
        for (std::size_t k = j; k < axes.size(); ++k) {
          Factors factors{axes[i], axes[j], axes[k]};
          std::ranges::sort(factors);
          if (factors[0] == factors[2] || !is_offered(symbol, factors)) continue;
          specs.push_back(
              effect_spec("triple-coupling", {{"symbol", symbol.name()}, {"axes", axes_text(factors)}}));
        }
      }
    }
  }
  return specs;
}

}  // namespace

const EffectKind& triple_coupling_effect() {
  static const FormulaKind kind(
      {.kind = "triple-coupling",
       .summary = "an error motion depends on the product of three positions, of which two may be of one "
                  "axis: a ram that bends more the further its saddle is out, y z^2; counted from home",
       .plain = "An error motion changes with the product of three positions: the machine bends the more, "
                "the farther several axes are out at once.",
       .usual_causes = "a ram that bends out of a saddle which is itself far out; an overhang on a "
                       "crossbeam; a heavy head on a long ram",
       .source = "ISO/TR 16907:2015, 7.4.2 (non-rigid behaviour)",
       .polynomial = true,
       .keys = joined({{symbol_key("error motion that changes: EAY ..."),
                        text_key("axes", "the three factors, \"Y Z Z\" for y z^2")},
                       motion_amplitude_keys({"per_m3"}, "change per cubic metre")})},
      make_triple_coupling, triple_couplings);
  return kind;
}

}  // namespace volcal
