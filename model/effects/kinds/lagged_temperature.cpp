// What follows a temperature late: a heavy casting behind the air or a sensor on its surface.
#include <algorithm>
#include <cmath>

#include "volcal/model/description/units.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kUsualLag = kSecondsPerHour;
constexpr double kShortestLag = 600.0;
constexpr double kLongestLag = 14400.0;
constexpr int kLags = 8;

struct Sample {
  double time = 0.0;         ///< s
  double temperature = 0.0;  ///< degC
};

bool has_both(const Setup& setup, const std::string& channel) {
  return !setup.readings.time.empty() && setup.readings.temperature.contains(channel);
}

/// The channel of the whole campaign in the order of time.
std::vector<Sample> samples_of(const Campaign& campaign, const std::string& channel) {
  std::vector<Sample> samples;
  for (const Setup& setup : campaign.setups) {
    if (!has_both(setup, channel)) continue;
    const std::vector<double>& temperature = setup.readings.temperature.at(channel);
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      samples.push_back({setup.readings.time[row], temperature[row]});
    }
  }
  if (!std::ranges::is_sorted(samples, {}, &Sample::time)) {
    std::ranges::stable_sort(samples, {}, &Sample::time);
  }
  return samples;
}

/// Solves lag y' = T - y in place, T piecewise linear between the samples, y = T at the first.
void follow(std::vector<Sample>& samples, double lag) {
  double before = samples.front().temperature;
  double step = -1.0, left = 1.0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double after = samples[i].temperature;
    const double dt = samples[i].time - samples[i - 1].time;
    double& followed = samples[i].temperature;
    followed = samples[i - 1].temperature;
    if (dt > 0.0) {
      if (dt != step) left = std::exp(-dt / lag);
      step = dt;
      const double slope = (after - before) / dt;
      followed = after - slope * lag + (followed - before + slope * lag) * left;
    }
    before = after;
  }
}

/// Lagged temperature less 20 degC per reading; 0 where time or channel were not recorded.
Eigen::VectorXd lagged_excess(const SetupView& view, const std::string& channel, double lag) {
  Eigen::VectorXd excess = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(view.rows()));
  if (!has_both(view.setup, channel)) return excess;
  std::vector<Sample> samples = samples_of(view.campaign, channel);
  follow(samples, lag);
  for (std::size_t row = 0; row < view.rows(); ++row) {
    const auto at = std::ranges::lower_bound(samples, view.setup.readings.time[row], {}, &Sample::time);
    excess[static_cast<Eigen::Index>(row)] = at->temperature - kReferenceTemperature_degC;
  }
  return excess;
}

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
  effect.count_unrecorded(
      [channel](const SetupView& view) { return has_both(view.setup, channel) ? 0 : view.rows(); });
}

void check_recorded(const Campaign& campaign, const std::string& channel, const std::string& label,
                    const SourcePlace& place) {
  check_channel(campaign, channel, place);
  check_time(campaign, label, place);
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
        check_recorded(campaign, channel, label, place);
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
        check_recorded(campaign, channel, label, place);
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
