// Reversal that changes along the travel: a screw worn in the middle, a cable chain.
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/reversal_label.h"

namespace volcal {
namespace {

EffectSchema position_reversal_schema() {
  return {.kind = "position-reversal",
          .summary =
              "the reversal of an error motion changes along the travel of its own axis by this much per "
              "metre; counted from home",
          .plain = "The play at reversal is not the same everywhere on the travel.",
          .usual_causes =
              "a ball screw that is worn where it is used most; guideways or wipers that are tighter at one "
              "end; a screw that winds up by the more the farther the nut is from its bearing",
          .source = "ISO 230-2:2014, 3.11 (reversal value at a position)",
          .polynomial = true,
          .keys = joined({{symbol_key("error motion whose reversal changes: EXX ...")},
                          motion_amplitude_keys({"per_m"}, "change of b per metre of travel")})};
}

std::unique_ptr<FormulaEffect> make_position_reversal(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  const std::string label = reversal_label(symbol) + " along the travel";
  return std::make_unique<FormulaEffect>(
      EffectName{"position-reversal", symbol,
                 EffectDriver({direction_of_approach(symbol.axis), position_of(symbol.axis)}), "linear"},
      std::vector{motion_amplitude(table, label, symbol, "per_m")},
      [symbol](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return 0.5 * directions(view, symbol.axis).cwiseProduct(positions_from_home(view, symbol.axis));
      },
      [symbol, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
      });
}

std::vector<EffectSpec> position_reversals(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
    specs.push_back(effect_spec("position-reversal", {{"symbol", symbol.name()}}));
  }
  return specs;
}

}  // namespace

const EffectKind& position_reversal_effect() {
  static const FormulaKind kind(position_reversal_schema(), make_position_reversal, position_reversals);
  return kind;
}

}  // namespace volcal
