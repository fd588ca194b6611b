// What follows a temperature late: a heavy casting behind the air or a sensor on its surface.
#include <algorithm>
#include <cmath>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/lagged_channel.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kUsualLag = kSecondsPerHour;
constexpr double kShortestLag = 600.0;
constexpr double kLongestLag = 14400.0;
constexpr int kLags = 8;

/// Adds the lag to an effect; no lag is looked for that is longer than the campaign.
void add_lag(const EffectTable& table, const std::string& label, const std::string& channel,
             FormulaEffect& effect) {
  const EffectShape lag = shape_parameter(table, label + ": time constant", "time_constant", "s", kUsualLag,
                                          kShortestLag, kLongestLag);
  if (!(lag.value > 0.0)) table.fail("its time constant is not positive", "give time_constant_s = 3600.0");
  effect.add_shape(lag);
  effect.scan_by([](const Campaign& /*campaign*/) {
    std::vector<Eigen::VectorXd> values;
    for (int i = 0; i < kLags; ++i) {
      const double share = static_cast<double>(i) / (kLags - 1);
      values.emplace_back(
          Eigen::VectorXd::Constant(1, kShortestLag * std::pow(kLongestLag / kShortestLag, share)));
    }
    return values;
  });
  effect.count_unrecorded([channel](const SetupView& view) {
    return has_time_and_channel(view.setup, channel) ? 0 : view.rows();
  });
}

std::unique_ptr<FormulaEffect> make_lagged_temperature(const EffectTable& table) {
  const ErrorSymbol symbol = table.symbol();
  const std::string channel = table.text("temperature", "add temperature = \"CHANNEL\"");
  const std::string label = symbol.name() + " late by " + channel;
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"lagged-temperature", symbol.name(), "T_" + channel, "lag"},
      std::vector{motion_amplitude(table, label, symbol, "per_K")},
      [channel](const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        return lagged_excess(view, channel, shape[0]);
      },
      [symbol, channel, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
        check_time_and_channel(campaign, channel, label, place);
      });
  add_lag(table, label, channel, *effect);
  return effect;
}

std::unique_ptr<FormulaEffect> make_lagged_expansion(const EffectTable& table) {
  const std::string channel = table.text("temperature", "add temperature = \"CHANNEL\"");
  const std::string label = "tool late by " + channel;
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"lagged-expansion", "tool", "T_" + channel, "lag"},
      vector_amplitudes(table, label, TargetKind::ToolOffset, "um_per_K"),
      [channel](const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        return lagged_excess(view, channel, shape[0]).replicate(1, 3);
      },
      [channel, label](const Campaign& campaign, const SourcePlace& place) {
        check_time_and_channel(campaign, channel, label, place);
      });
  add_lag(table, label, channel, *effect);
  return effect;
}

/// Rotations, as of the immediate effect: displacements are scale, straightness or the tool's.
std::vector<EffectSpec> lagged_temperatures(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  if (!has_time(campaign)) return specs;
  for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
    if (!is_rotation(symbol.component)) continue;
    for (const std::string& channel : temperature_channels(campaign)) {
      specs.push_back(
          effect_spec("lagged-temperature", {{"symbol", symbol.name()}, {"temperature", channel}}));
    }
  }
  return specs;
}

std::vector<EffectSpec> lagged_expansions(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  if (!has_time(campaign)) return specs;
  for (const std::string& channel : temperature_channels(campaign)) {
    specs.push_back(effect_spec("lagged-expansion", {{"temperature", channel}}));
  }
  return specs;
}

}  // namespace

const EffectKind& lagged_temperature_effect() {
  static const FormulaKind kind(
      {.kind = "lagged-temperature",
       .summary = "an error motion shifts with a temperature, but late: a (T1 - 20 degC), T1 follows the "
                  "channel with a time constant from the first reading on",
       .source = "ISO 230-3 (distortion caused by temperature); first-order lag of a lumped thermal mass",
       .keys = joined({{symbol_key("error motion that shifts: EAZ ..."),
                        text_key("temperature", "channel: column T_<channel>_degC")},
                       shape_keys("time_constant", "s", "of the lag"),
                       motion_amplitude_keys({"per_K"}, "shift per kelvin")})},
      make_lagged_temperature, lagged_temperatures);
  return kind;
}

const EffectKind& lagged_expansion_effect() {
  static const FormulaKind kind(
      {.kind = "lagged-expansion",
       .summary = "spindle or tool follow a temperature late: a (T1 - 20 degC), tool coordinates, T1 follows "
                  "the channel with a time constant from the first reading on",
       .source = "ISO 230-3 (distortion caused by temperature); first-order lag of a lumped thermal mass",
       .keys = joined({{text_key("temperature", "channel: column T_<channel>_degC")},
                       shape_keys("time_constant", "s", "of the lag"),
                       vector_amplitude_keys("um_per_K", "displacement per kelvin")})},
      make_lagged_expansion, lagged_expansions);
  return kind;
}

}  // namespace volcal
