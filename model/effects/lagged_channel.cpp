#include "volcal/model/effects/lagged_channel.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/model/description/units.h"

namespace volcal {
namespace {

struct Sample {
  double time = 0.0;         ///< s
  double temperature = 0.0;  ///< degC
};

/// The channel of the whole campaign in the order of time.
std::vector<Sample> samples_of(const Campaign& campaign, const std::string& channel) {
  std::vector<Sample> samples;
  for (const Setup& setup : campaign.setups) {
    if (!has_time_and_channel(setup, channel)) continue;
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

}  // namespace

bool has_time_and_channel(const Setup& setup, const std::string& channel) {
  return !setup.readings.time.empty() && setup.readings.temperature.contains(channel);
}

void check_time_and_channel(const Campaign& campaign, const std::string& channel, const std::string& label,
                            const SourcePlace& place) {
  check_channel(campaign, channel, place);
  check_time(campaign, label, place);
}

KeptHistories::Values KeptHistories::find(const std::string& channel, double lag) const {
  const std::lock_guard lock(mutex_);
  const auto found = known_.find({channel, lag});
  return found == known_.end() ? nullptr : found->second;
}

void KeptHistories::keep(const std::string& channel, double lag, Values values) {
  const std::lock_guard lock(mutex_);
  if (known_.size() >= kMost) known_.clear();
  known_[{channel, lag}] = std::move(values);
}

namespace {

Eigen::VectorXd found_excess(const SetupView& view, const std::string& channel, double lag) {
  std::vector<Sample> samples = samples_of(view.campaign, channel);
  follow(samples, lag);
  Eigen::VectorXd excess(static_cast<Eigen::Index>(view.rows()));
  for (std::size_t row = 0; row < view.rows(); ++row) {
    const auto at = std::ranges::lower_bound(samples, view.setup.readings.time[row], {}, &Sample::time);
    excess[static_cast<Eigen::Index>(row)] = at->temperature - kReferenceTemperature_degC;
  }
  return excess;
}

}  // namespace

Eigen::VectorXd lagged_excess(const SetupView& view, const std::string& channel, double lag) {
  if (!has_time_and_channel(view.setup, channel))
    return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(view.rows()));
  if (!view.histories) return found_excess(view, channel, lag);
  KeptHistories::Values known = view.histories->find(channel, lag);
  if (!known) {
    known = std::make_shared<const Eigen::VectorXd>(found_excess(view, channel, lag));
    view.histories->keep(channel, lag, known);
  }
  return *known;
}

namespace {

FormulaEffect::Formula formula_of(const ChannelHistory& history, const std::string& channel,
                                  Eigen::Index amplitudes) {
  return [values = history.values, channel, amplitudes](const SetupView& view,
                                                        const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
    return values(view, channel, shape[0]).replicate(1, amplitudes);
  };
}

FormulaEffect::Count without_history(const std::string& channel) {
  return [channel](const SetupView& view) {
    return has_time_and_channel(view.setup, channel) ? 0 : view.rows();
  };
}

std::string channel_of(const EffectTable& table) {
  return table.text("temperature", "add temperature = \"CHANNEL\"");
}

}  // namespace

std::unique_ptr<FormulaEffect> motion_by_history(const EffectTable& table, const ChannelHistory& history) {
  const ErrorSymbol symbol = table.symbol();
  const std::string channel = channel_of(table), label = symbol.name() + " " + history.label;
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{table.spec.kind, symbol, history.driver, history.shape},
      std::vector{motion_amplitude(table, label, symbol, "per_K")}, formula_of(history, channel, 1),
      [symbol, channel, label](const Campaign& campaign, const SourcePlace& place) {
        check_axis(campaign, symbol.axis, label, place);
        check_time_and_channel(campaign, channel, label, place);
      });
  effect->count_unrecorded(without_history(channel));
  return effect;
}

std::unique_ptr<FormulaEffect> tool_by_history(const EffectTable& table, const ChannelHistory& history) {
  const std::string channel = channel_of(table), label = "tool " + history.label;
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{table.spec.kind, TargetName::of_tool(), history.driver, history.shape},
      vector_amplitudes(table, label, TargetKind::ToolOffset, "um_per_K"), formula_of(history, channel, 3),
      [channel, label](const Campaign& campaign, const SourcePlace& place) {
        check_time_and_channel(campaign, channel, label, place);
      });
  effect->count_unrecorded(without_history(channel));
  return effect;
}

std::vector<EffectSpec> rotations_by_history(const Campaign& campaign, const std::string& kind) {
  std::vector<EffectSpec> specs;
  if (!has_time(campaign)) return specs;
  for (const ErrorSymbol symbol : linear_axis_motions(campaign.machine)) {
    if (!is_rotation(symbol.component)) continue;
    for (const std::string& channel : temperature_channels(campaign))
      specs.push_back(effect_spec(kind, {{"symbol", symbol.name()}, {"temperature", channel}}));
  }
  return specs;
}

std::vector<EffectSpec> tools_by_history(const Campaign& campaign, const std::string& kind) {
  std::vector<EffectSpec> specs;
  if (!has_time(campaign)) return specs;
  for (const std::string& channel : temperature_channels(campaign))
    specs.push_back(effect_spec(kind, {{"temperature", channel}}));
  return specs;
}

}  // namespace volcal
