// What follows how fast a temperature changes: a casting bends while its skin is warmer than its core.
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

ChannelHistory rate_of(const EffectTable& table) {
  const std::string channel = table.spec.options.text("temperature").value_or("");
  const Variable temperature = temperature_of(channel);
  return {"by the rate of " + channel, EffectDriver::called("rate of " + temperature.name(), {temperature}),
          "linear", ahead_of_core};
}

std::unique_ptr<FormulaEffect> with_core(const EffectTable& table, std::unique_ptr<FormulaEffect> effect,
                                         const std::string& what) {
  const EffectShape constant =
      shape_parameter(table, what + " " + rate_of(table).label + ": time constant", "time_constant", "s",
                      kUsualConstant, kUsualConstant, kUsualConstant);
  if (!(constant.value > 0.0))
    table.fail("its time constant is not positive", "give time_constant_s = 1800.0");
  effect->add_shape(constant);
  return effect;
}

std::unique_ptr<FormulaEffect> make_temperature_rate(const EffectTable& table) {
  return with_core(table, motion_by_history(table, rate_of(table)), table.symbol().name());
}

std::unique_ptr<FormulaEffect> make_tool_rate(const EffectTable& table) {
  return with_core(table, tool_by_history(table, rate_of(table)), "tool");
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
       .plain = "An error motion follows how fast a temperature changes: the structure bends while its skin "
                "is warmer than its core.",
       .usual_causes =
           "a hall door, sun or heating that comes on; coolant that starts; a thick casting with thin ribs",
       .source = kSource,
       .polynomial = true,
       .keys = joined({{symbol_key("error motion that bends: EAZ ..."),
                        text_key("temperature", "channel: column T_<channel>_degC")},
                       shape_keys("time_constant", "s", kConstant),
                       motion_amplitude_keys({"per_K"}, "per kelvin between skin and core")})},
      make_temperature_rate,
      [](const Campaign& campaign) { return rotations_by_history(campaign, "temperature-rate"); });
  return kind;
}

const EffectKind& tool_rate_effect() {
  static const FormulaKind kind(
      {.kind = "tool-temperature-rate",
       .summary =
           "spindle or tool follow how fast a temperature changes: a (T - T1), tool coordinates, T1 follows "
           "the channel with a time constant tau, so that slow changes give a tau dT/dt",
       .plain = "Spindle or tool move while a temperature changes, and return when it is steady.",
       .usual_causes = "a spindle housing whose skin warms before its core; a spindle cooler that switches; "
                       "coolant that starts",
       .source = kSource,
       .polynomial = true,
       .keys = joined({{text_key("temperature", "channel: column T_<channel>_degC")},
                       shape_keys("time_constant", "s", kConstant),
                       vector_amplitude_keys("um_per_K", "displacement per kelvin between skin and core")})},
      make_tool_rate,
      [](const Campaign& campaign) { return tools_by_history(campaign, "tool-temperature-rate"); });
  return kind;
}

}  // namespace volcal
