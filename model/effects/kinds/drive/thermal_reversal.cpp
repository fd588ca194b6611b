// Reversal that changes with a temperature: the preload of a nut, a belt or a rack grows and shrinks with it.
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/reversal_label.h"

namespace volcal {
namespace {

std::unique_ptr<FormulaEffect> make_thermal_reversal(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  const std::string channel = table.text("temperature", "add temperature = \"CHANNEL\"");
  const std::string label = reversal_label(symbol) + " by " + channel;
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"thermal-reversal", symbol,
                 EffectDriver({direction_of_approach(symbol.axis), temperature_of(channel)}), "linear"},
      std::vector{motion_amplitude(table, label, symbol, "per_K")},
      [axis = symbol.axis, channel](const SetupView& view,
                                    const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        return 0.5 * directions(view, axis).cwiseProduct(temperature_excess(view, channel));
      },
      [symbol, channel, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
        check_channel(campaign, channel, place);
      });
  effect->count_unrecorded(without_channel(channel));
  return effect;
}

std::vector<EffectSpec> thermal_reversals(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
    for (const std::string& channel : temperature_channels(campaign)) {
      specs.push_back(effect_spec("thermal-reversal", {{"symbol", symbol.name()}, {"temperature", channel}}));
    }
  }
  return specs;
}

}  // namespace

const EffectKind& thermal_reversal_effect() {
  static const FormulaKind kind(
      {.kind = "thermal-reversal",
       .summary = "the reversal of an error motion changes with a temperature by this much per kelvin; "
                  "counted from 20 degC",
       .plain = "The play at reversal changes with a temperature.",
       .usual_causes = "preload of nut or bearings that changes as they warm; grease that stiffens in the "
                       "cold; a screw that lengthens between fixed bearings",
       .source = "ISO 230-2:2014, 3.11 (reversal value), ISO 230-3 (thermal effects)",
       .polynomial = true,
       .keys = joined({{symbol_key("error motion whose reversal changes: EXX ..."),
                        text_key("temperature", "channel: column T_<channel>_degC")},
                       motion_amplitude_keys({"per_K"}, "change of b per kelvin")})},
      make_thermal_reversal, thermal_reversals);
  return kind;
}

}  // namespace volcal
