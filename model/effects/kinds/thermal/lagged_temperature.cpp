// What follows a temperature late: a heavy casting behind the air or a sensor on its surface.
#include <cmath>

#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/lagged_channel.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kUsualLag = kSecondsPerHour;
constexpr double kShortestLag = 600.0;
constexpr double kLongestLag = 14400.0;
constexpr int kLags = 8;

ChannelHistory lag_of(const EffectTable& table) {
  const std::string channel = table.spec.options.text("temperature").value_or("");
  return {"late by " + channel, temperature_of(channel), "lag", lagged_excess};
}

std::vector<Eigen::VectorXd> lags() {
  std::vector<Eigen::VectorXd> values;
  for (int i = 0; i < kLags; ++i) {
    const double share = static_cast<double>(i) / (kLags - 1);
    values.emplace_back(
        Eigen::VectorXd::Constant(1, kShortestLag * std::pow(kLongestLag / kShortestLag, share)));
  }
  return values;
}

std::unique_ptr<FormulaEffect> with_lag(const EffectTable& table, std::unique_ptr<FormulaEffect> effect,
                                        const std::string& what) {
  const EffectShape lag = shape_parameter(table, what + " " + lag_of(table).label + ": time constant",
                                          "time_constant", "s", kUsualLag, kShortestLag, kLongestLag);
  if (!(lag.value > 0.0)) table.fail("its time constant is not positive", "give time_constant_s = 3600.0");
  effect->add_shape(lag);
  effect->scan_by([](const Campaign& /*campaign*/) { return lags(); });
  return effect;
}

std::unique_ptr<FormulaEffect> make_lagged_temperature(const EffectTable& table) {
  return with_lag(table, motion_by_history(table, lag_of(table)), table.symbol().name());
}

std::unique_ptr<FormulaEffect> make_lagged_expansion(const EffectTable& table) {
  return with_lag(table, tool_by_history(table, lag_of(table)), "tool");
}

}  // namespace

const EffectKind& lagged_temperature_effect() {
  static const FormulaKind kind(
      {.kind = "lagged-temperature",
       .summary = "an error motion shifts with a temperature, but late: a (T1 - 20 degC), T1 follows the "
                  "channel with a time constant from the first reading on",
       .plain = "An error motion follows a temperature, but hours late: a heavy part takes time to warm.",
       .usual_causes = "the bed, column or table following the workshop's temperature; sun or a heater on "
                       "one side; coolant that warms the structure slowly",
       .source = "ISO 230-3 (distortion caused by temperature); first-order lag of a lumped thermal mass",
       .polynomial = true,
       .keys = joined({{symbol_key("error motion that shifts: EAZ ..."),
                        text_key("temperature", "channel: column T_<channel>_degC")},
                       shape_keys("time_constant", "s", "of the lag"),
                       motion_amplitude_keys({"per_K"}, "shift per kelvin")})},
      make_lagged_temperature,
      [](const Campaign& campaign) { return rotations_by_history(campaign, "lagged-temperature"); });
  return kind;
}

const EffectKind& lagged_expansion_effect() {
  static const FormulaKind kind(
      {.kind = "lagged-expansion",
       .summary = "spindle or tool follow a temperature late: a (T1 - 20 degC), tool coordinates, T1 follows "
                  "the channel with a time constant from the first reading on",
       .plain = "Spindle or tool grow with a temperature, but late.",
       .usual_causes = "a spindle housing that warms through; a tool holder that takes up heat from the "
                       "bearings; coolant at another temperature than the machine",
       .source = "ISO 230-3 (distortion caused by temperature); first-order lag of a lumped thermal mass",
       .polynomial = true,
       .keys = joined({{text_key("temperature", "channel: column T_<channel>_degC")},
                       shape_keys("time_constant", "s", "of the lag"),
                       vector_amplitude_keys("um_per_K", "displacement per kelvin")})},
      make_lagged_expansion,
      [](const Campaign& campaign) { return tools_by_history(campaign, "lagged-expansion"); });
  return kind;
}

}  // namespace volcal
