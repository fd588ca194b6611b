// Scales of one material at one temperature: the same coefficient of expansion on every axis.
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/shared_motions.h"

namespace volcal {
namespace {

std::unique_ptr<FormulaEffect> make_common_expansion(const EffectTable& table) {
  const std::vector<AxisName> axes = shared_axes(table);
  const std::vector<ErrorSymbol> symbols = positioning_errors(axes);
  const std::string channel = table.text("temperature", "add temperature = \"CHANNEL\"");
  const std::string label = "common expansion of " + names_of_axes(axes) + " by " + channel;
  EffectAmplitude amplitude{.label = label,
                            .target = targets_of(symbols).front(),
                            .key = "amplitude_um_per_m_K",
                            .guess = table.number("amplitude", 0.0)};
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"common-expansion", TargetName(symbols), temperature_of(channel), "linear"},
      std::vector{std::move(amplitude)},
      [axes, channel](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        const Eigen::VectorXd excess = temperature_excess(view, channel);
        Eigen::MatrixXd strains(excess.size(), static_cast<Eigen::Index>(axes.size()));
        for (std::size_t k = 0; k < axes.size(); ++k)
          strains.col(static_cast<Eigen::Index>(k)) = positions_from_home(view, axes[k]).cwiseProduct(excess);
        return strains;
      },
      [axes, channel, label](const Campaign& campaign, const SourcePlace& place) {
        for (const AxisName axis : axes) check_axis(campaign, axis, label, place);
        check_channel(campaign, channel, place);
      });
  effect->act_on(targets_of(symbols));
  effect->count_unrecorded(without_channel(channel));
  return effect;
}

std::vector<EffectSpec> common_expansions(const Campaign& campaign) {
  const std::vector<AxisName> axes = axes_that_move(campaign);
  std::vector<EffectSpec> specs;
  if (axes.size() < 2) return specs;
  for (const std::string& channel : temperature_channels(campaign))
    specs.push_back(
        effect_spec("common-expansion", {{"axes", names_of_axes(axes)}, {"temperature", channel}}));
  return specs;
}

}  // namespace

const EffectKind& common_expansion_effect() {
  static const FormulaKind kind(
      {.kind = "common-expansion",
       .summary = "the scales of several axes expand from home by the same coefficient with one temperature; "
                  "counted from 20 degC",
       .plain = "All axes become longer alike as the machine warms.",
       .usual_causes =
           "scales of one material at one temperature; a reference temperature or coefficient that the "
           "control has wrong for all axes; a length scale of the instrument that follows that temperature",
       .source = "ISO 230-3:2020 (thermal effects); ISO 1:2022 (20 degC)",
       .polynomial = true,
       .expands_scales = true,
       .keys = {shared_axes_key("axes whose scales are of one material: \"X Y Z\""),
                text_key("temperature", "channel: column T_<channel>_degC"),
                amplitude_key("amplitude_um_per_m_K", "expansion of each beyond what the control corrects")}},
      make_common_expansion, common_expansions);
  return kind;
}

}  // namespace volcal
