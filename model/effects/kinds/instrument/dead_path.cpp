// The part of a beam that is not measured: its air changes, with time or with a temperature.
#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "volcal/model/description/variable.h"
#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

/// One setup, those of a station, or all: where one cause acts with one amplitude.
struct DeadPathPlace {
  std::string setup;
  std::string station;

  explicit DeadPathPlace(const EffectTable& table)
      : setup(table.spec.options.text("setup").value_or("")),
        station(table.spec.options.text("station").value_or("")) {
    if (!setup.empty() && !station.empty())
      table.fail("it names a setup and a station", "leave one of them out; without both it is all lasers");
  }
  bool holds(const Setup& each) const {
    if (!setup.empty()) return each.name == setup;
    return measures_lengths(each) && (station.empty() || station_of(each) == station);
  }
  TargetName target() const {
    return station.empty() ? TargetName::of_readings(setup) : TargetName::of_station(station);
  }
  std::string label() const {
    if (!setup.empty()) return "dead path of " + setup;
    return station.empty() ? "dead path of all lasers" : "dead path at " + station;
  }
  void check(const Campaign& campaign, const SourcePlace& place) const {
    if (!setup.empty()) return check_setup(campaign, setup, place);
    if (!station.empty()) check_station(campaign, station, place);
    if (std::ranges::any_of(campaign.setups, [this](const Setup& each) { return holds(each); })) return;
    throw InputError(place, label() + ": no setup measures lengths with a laser there", "remove the effect");
  }
};

/// Seconds since the setup's first reading.
Eigen::VectorXd since_first_reading(const SetupView& view) {
  if (view.setup.readings.time.empty()) return constant(view, 0.0);
  return times(view).array() - view.setup.readings.time.front();
}

std::unique_ptr<FormulaEffect> make_dead_path(const EffectTable& table) {
  const DeadPathPlace where(table);
  const std::string channel = table.spec.options.text("temperature").value_or("");
  const std::string label = where.label() + (channel.empty() ? " by time" : " by " + channel);
  return std::make_unique<FormulaEffect>(
      EffectName{"dead-path", where.target(), temperature_or_time(channel), "linear"},
      std::vector{
          reading_amplitude(table, label, channel.empty() ? "amplitude_um_per_h" : "amplitude_um_per_K")},
      [where, channel](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        if (!where.holds(view.setup)) return constant(view, 0.0);
        return channel.empty() ? since_first_reading(view) : temperature_excess(view, channel);
      },
      [where, channel](const Campaign& campaign, const SourcePlace& place) {
        if (!channel.empty()) check_channel(campaign, channel, place);
        where.check(campaign, place);
      });
}

void add_dead_paths(const std::optional<std::pair<std::string, std::string>>& where, bool timed,
                    const std::vector<std::string>& channels, std::vector<EffectSpec>& specs) {
  const auto add = [&](std::string_view channel) {
    EffectSpec& spec = specs.emplace_back(effect_spec("dead-path", {}));
    if (where) spec.options.set(where->first, where->second);
    if (!channel.empty()) spec.options.set("temperature", std::string(channel));
  };
  if (timed) add("");
  for (const std::string& channel : channels) add(channel);
}

/// Every setup on its own; every station with several setups, and all lasers, as one cause.
std::vector<EffectSpec> dead_paths(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  std::map<std::string, int> setups_at;
  int lasers = 0;
  for (const Setup& setup : campaign.setups) {
    if (!measures_lengths(setup)) continue;
    std::vector<std::string> channels;
    for (const auto& [channel, values] : setup.readings.temperature) channels.push_back(channel);
    add_dead_paths(std::pair{"setup", setup.name}, !setup.readings.time.empty(), channels, specs);
    ++lasers;
    if (const std::string station = station_of(setup); !station.empty()) ++setups_at[station];
  }
  const std::vector<std::string> channels = temperature_channels(campaign);
  for (const auto& [station, setups] : setups_at) {
    if (setups > 1 && setups < lasers)
      add_dead_paths(std::pair{"station", station}, has_time(campaign), channels, specs);
  }
  if (lasers > 1) add_dead_paths(std::nullopt, has_time(campaign), channels, specs);
  return specs;
}

}  // namespace

const EffectKind& dead_path_effect() {
  static const FormulaKind kind(
      {.kind = "dead-path",
       .summary =
           "the dead path of a setup, of all at a station, or of all lasers, changes with time or with a "
           "temperature (air index, thermal drift)",
       .plain = "All lengths from one station drift together with the air or with time: the part of the beam "
                "that is not measured changes.",
       .usual_causes = "a dead path that was not compensated; a station or mount that warms up; a reference "
                       "that was set long before the readings",
       .source = "ISO 230-6; Edlen, Metrologia 2 (1966) 71",
       .keys = {text_key("setup", "only this setup", false),
                text_key("station", "all setups at this station; absent, as the setup = all lasers", false),
                text_key("temperature", "channel that drives it; absent = time", false),
                amplitude_key("amplitude_um_per_h", "change of the reading per hour"),
                amplitude_key("amplitude_um_per_K", "change of the reading per kelvin")}},
      make_dead_path, dead_paths);
  return kind;
}

}  // namespace volcal
