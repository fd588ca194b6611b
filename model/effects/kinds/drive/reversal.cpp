#include <algorithm>

#include "volcal/model/description/variable.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/reversal_label.h"

namespace volcal {
namespace {

EffectSchema reversal_schema() {
  return {.kind = "reversal",
          .summary =
              "an error motion differs by b between the two directions of approach of its own axis; the "
              "error function is the mean, readings of unknown direction get 0",
          .plain = "An axis stops at two different places, depending on the side from which it comes.",
          .usual_causes =
              "backlash of screw, nut or gear; friction that winds up the drive; loose couplings or "
              "bearings; a backlash compensation in the control that is missing or wrong; a scale that sits "
              "far from the guideway",
          .source = "ISO 230-1 and ISO 230-2 (reversal value), as quoted in ISO/TR 16907:2015",
          .polynomial = true,
          .keys = joined({{symbol_key("error motion that jumps at reversal: EXX, EYX, ECX ...")},
                          motion_amplitude_keys({""}, "b: value towards + minus value towards -")})};
}

std::unique_ptr<FormulaEffect> make_reversal(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  const std::string label = reversal_label(symbol);
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"reversal", symbol, direction_of_approach(symbol.axis), "step"},
      std::vector{motion_amplitude(table, label, symbol, "")},
      [symbol](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return 0.5 * directions(view, symbol.axis);
      },
      [symbol, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
      });
  effect->count_unrecorded([symbol](const SetupView& view) {
    const auto& direction = view.setup.readings.direction[index_of(symbol.axis)];
    return direction.empty() ? view.rows()
                             : static_cast<std::size_t>(std::ranges::count(direction, std::int8_t{0}));
  });
  return effect;
}

std::vector<EffectSpec> reversals(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const ErrorSymbol symbol : motions_in_campaign(campaign)) {
    specs.push_back(effect_spec("reversal", {{"symbol", symbol.name()}}));
  }
  return specs;
}

}  // namespace

const EffectKind& reversal_effect() {
  static const FormulaKind kind(reversal_schema(), make_reversal, reversals);
  return kind;
}

}  // namespace volcal
