// Reversal that changes with the square of the travel: a screw that sags or is worn in the middle.
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/reversal_label.h"

namespace volcal {
namespace {

std::unique_ptr<FormulaEffect> make_curved_reversal(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  const std::string label = reversal_label(symbol) + " along the travel, curved";
  return std::make_unique<FormulaEffect>(
      EffectName{"curved-reversal", symbol,
                 EffectDriver({direction_of_approach(symbol.axis), position_of(symbol.axis)}), "quadratic"},
      std::vector{motion_amplitude(table, label, symbol, "per_m2")},
      [axis = symbol.axis](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return 0.5 * directions(view, axis).array() * positions_from_home(view, axis).array().square();
      },
      [symbol, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
      });
}

std::vector<EffectSpec> curved_reversals(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
    specs.push_back(effect_spec("curved-reversal", {{"symbol", symbol.name()}}));
  }
  return specs;
}

}  // namespace

const EffectKind& curved_reversal_effect() {
  static const FormulaKind kind(
      {.kind = "curved-reversal",
       .summary = "the reversal of an error motion changes with the square of the position of its own axis; "
                  "counted from home, beside reversal and position-reversal",
       .plain = "The play at reversal is larger or smaller in the middle of the travel than at its ends.",
       .usual_causes = "a ball screw that is worn in the middle; a long screw that sags; guideways that are "
                       "tight at both ends",
       .source = "ISO 230-2:2014, 3.11 (reversal value at a position)",
       .polynomial = true,
       .keys = joined({{symbol_key("error motion whose reversal changes: EXX ...")},
                       motion_amplitude_keys({"per_m2"}, "change of b per square metre of travel")})},
      make_curved_reversal, curved_reversals);
  return kind;
}

}  // namespace volcal
