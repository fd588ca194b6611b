// What follows how fast a temperature changes: a casting bends while its skin is warmer than its core.
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/lagged_channel.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kUsualConstant = 1800.0;  // s

/// Skin less core.
Eigen::VectorXd ahead_of_core(const SetupView& view, const std::string& channel, double time_constant) {
  if (!has_time_and_channel(view.setup, channel)) return constant(view, 0.0);
  return temperature_excess(view, channel) - lagged_excess(view, channel, time_constant);
}

void add_time_constant(const EffectTable& table, const std::string& label, const std::string& channel,
                       FormulaEffect& effect) {
  const EffectShape constant = shape_parameter(table, label + ": time constant", "time_constant", "s",
                                               kUsualConstant, kUsualConstant, kUsualConstant);
  if (!(constant.value > 0.0))
    table.fail("its time constant is not positive", "give time_constant_s = 1800.0");
  effect.add_shape(constant);
  effect.count_unrecorded([channel](const SetupView& view) {
    return has_time_and_channel(view.setup, channel) ? 0 : view.rows();
  });
}

std::unique_ptr<FormulaEffect> make_temperature_rate(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  const std::string channel = table.text("temperature", "add temperature = \"CHANNEL\"");
  const std::string label = symbol.name() + " by the rate of " + channel;
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"temperature-rate", symbol.name(), "rate of T_" + channel, "linear"},
      std::vector{motion_amplitude(table, label, symbol, "per_K")},
      [channel](const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        return ahead_of_core(view, channel, shape[0]);
      },
      [symbol, channel, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
        check_time_and_channel(campaign, channel, label, place);
      });
  add_time_constant(table, label, channel, *effect);
  return effect;
}

std::unique_ptr<FormulaEffect> make_tool_rate(const EffectTable& table) {
  const std::string channel = table.text("temperature", "add temperature = \"CHANNEL\"");
  const std::string label = "tool by the rate of " + channel;
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"tool-temperature-rate", "tool", "rate of T_" + channel, "linear"},
      vector_amplitudes(table, label, TargetKind::ToolOffset, "um_per_K"),
      [channel](const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        return ahead_of_core(view, channel, shape[0]).replicate(1, 3);
      },
      [channel, label](const Campaign& campaign, const SourcePlace& place) {
        check_time_and_channel(campaign, channel, label, place);
      });
  add_time_constant(table, label, channel, *effect);
  return effect;
}

/// Rotations, as of the temperature itself: displacements are scale, straightness or the tool's.
std::vector<EffectSpec> temperature_rates(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  if (!has_time(campaign)) return specs;
  for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
    if (!is_rotation(symbol.component)) continue;
    for (const std::string& channel : temperature_channels(campaign)) {
      specs.push_back(effect_spec("temperature-rate", {{"symbol", symbol.name()}, {"temperature", channel}}));
    }
  }
  return specs;
}

std::vector<EffectSpec> tool_rates(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  if (!has_time(campaign)) return specs;
  for (const std::string& channel : temperature_channels(campaign))
    specs.push_back(effect_spec("tool-temperature-rate", {{"temperature", channel}}));
  return specs;
}

constexpr const char* kSource = "ISO 230-3 (distortion caused by temperature gradients); lumped thermal mass";
constexpr const char* kConstant = "of the core; the usual 1800 s unless given";

}  // namespace

const EffectKind& temperature_rate_effect() {
  static const FormulaKind kind(
      {.kind = "temperature-rate",
       .summary =
           "an error motion follows how fast a temperature changes, as a casting bends while its skin is "
           "warmer than its core: a (T - T1), T1 follows the channel with a time constant tau, so that "
           "slow changes give a tau dT/dt",
       .source = kSource,
       .keys = joined({{symbol_key("error motion that bends: EAZ ..."),
                        text_key("temperature", "channel: column T_<channel>_degC")},
                       shape_keys("time_constant", "s", kConstant),
                       motion_amplitude_keys({"per_K"}, "per kelvin between skin and core")})},
      make_temperature_rate, temperature_rates);
  return kind;
}

const EffectKind& tool_rate_effect() {
  static const FormulaKind kind(
      {.kind = "tool-temperature-rate",
       .summary =
           "spindle or tool follow how fast a temperature changes: a (T - T1), tool coordinates, T1 follows "
           "the channel with a time constant tau, so that slow changes give a tau dT/dt",
       .source = kSource,
       .keys = joined({{text_key("temperature", "channel: column T_<channel>_degC")},
                       shape_keys("time_constant", "s", kConstant),
                       vector_amplitude_keys("um_per_K", "displacement per kelvin between skin and core")})},
      make_tool_rate, tool_rates);
  return kind;
}

}  // namespace volcal
