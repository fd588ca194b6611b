// What the instrument does: length scale, stations that drift or are pushed, tool offsets.
#include <algorithm>
#include <cmath>
#include <set>

#include "volcal/model/effects/formula_effect.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/instruments/registry.h"

namespace volcal {
namespace {

constexpr double kSharpestEvent = 1.0;  // s
constexpr std::size_t kEventTimes = 24;

/// 1 from `event` on, 0 before, rising within a second so that it has a slope.
Eigen::ArrayXd after(const SetupView& view, double event) {
  return 0.5 * (1.0 + ((times(view, event - 1e6).array() - event) / kSharpestEvent).tanh());
}

std::unique_ptr<FormulaEffect> make_length_scale(const EffectTable& table) {
  const std::string station = table.spec.options.text("station").value_or("");
  const std::string label = station.empty() ? "length scale of all lasers" : "length scale at " + station;
  return std::make_unique<FormulaEffect>(
      EffectName{"length-scale",
                 station.empty() ? TargetName::of_readings() : TargetName::of_station(station),
                 Variable{Variable::Kind::Length}, "linear"},
      std::vector{reading_amplitude(table, label, "amplitude_ppm")},
      [station](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        const bool acts =
            measures_lengths(view.setup) && (station.empty() || station_of(view.setup) == station);
        if (!acts) return constant(view, 0.0);
        const bool along_beam = traits_of(view.setup).laser_length == LaserLength::Displacement;
        return along_beam ? beam_displacements(view) : view.length;
      },
      [station](const Campaign& campaign, const SourcePlace& place) {
        if (!station.empty()) check_station(campaign, station, place);
        for (const Setup& setup : campaign.setups) {
          if (measures_lengths(setup)) return;
        }
        throw InputError(place, "length scale: no setup measures lengths with a laser", "remove the effect");
      });
}

std::vector<EffectSpec> length_scales(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const Setup& setup : campaign.setups) {
    if (measures_lengths(setup) && specs.empty()) specs.push_back(effect_spec("length-scale", {}));
  }
  const auto stations = station_names(campaign);
  if (stations.size() < 2) return specs;
  for (const std::string& station : stations) {
    specs.push_back(effect_spec("length-scale", {{"station", station}}));
  }
  return specs;
}

std::unique_ptr<FormulaEffect> make_station_drift(const EffectTable& table) {
  const std::string station = table.spec.options.text("station").value_or("");
  const std::string label = station.empty() ? "drift of all stations" : "drift of station " + station;
  return std::make_unique<FormulaEffect>(
      EffectName{"station-drift", TargetName::of_station(station), Variable{Variable::Kind::Time}, "linear"},
      vector_amplitudes(table, label, TargetKind::Station, "um_per_h"),
      [station](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        const std::string own = station_of(view.setup);
        if (own.empty() || (!station.empty() && own != station)) return constant(view, 0.0).replicate(1, 3);
        const double start = clock_start(view);
        return (times(view, start).array() - start).matrix().replicate(1, 3);
      },
      [station, label](const Campaign& campaign, const SourcePlace& place) {
        if (!station.empty()) check_station(campaign, station, place);
        if (station_names(campaign).empty())
          throw InputError(place, label + ": no instrument of the campaign has a station",
                           "remove the effect");
        check_time(campaign, label, place);
      });
}

/// Every station on its own, and all as one: the machine drifts against its floor.
std::vector<EffectSpec> station_drifts(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  if (!has_time(campaign)) return specs;
  const auto stations = station_names(campaign);
  for (const std::string& station : stations) {
    specs.push_back(effect_spec("station-drift", {{"station", station}}));
  }
  if (stations.size() > 1) specs.push_back(effect_spec("station-drift", {}));
  return specs;
}

/// Between readings of the station, as many of them from one time to the next: visits may lie hours apart.
std::vector<Eigen::VectorXd> event_times(const Campaign& campaign, const std::string& station) {
  std::set<double> distinct;
  for (const Setup& setup : campaign.setups) {
    if (station_of(setup) == station) distinct.insert(setup.readings.time.begin(), setup.readings.time.end());
  }
  const std::vector<double> times(distinct.begin(), distinct.end());
  std::set<std::size_t> ranks;
  for (std::size_t i = 1; i < kEventTimes; ++i) ranks.insert(i * times.size() / kEventTimes);
  ranks.erase(0);
  std::vector<Eigen::VectorXd> values;
  values.reserve(ranks.size());
  for (const std::size_t rank : ranks) {
    values.emplace_back(Eigen::VectorXd::Constant(1, 0.5 * (times[rank - 1] + times[rank])));
  }
  return values;
}

std::unique_ptr<FormulaEffect> make_station_event(const EffectTable& table) {
  const std::string station = table.text("station", "add station = \"NAME\"");
  const std::string label = "event at station " + station;
  auto effect = std::make_unique<FormulaEffect>(
      EffectName{"station-event", TargetName::of_station(station), Variable{Variable::Kind::Time}, "step"},
      vector_amplitudes(table, label, TargetKind::Station, "um"),
      [station](const SetupView& view, const Eigen::VectorXd& shape) -> Eigen::MatrixXd {
        if (station_of(view.setup) != station) return constant(view, 0.0).replicate(1, 3);
        return after(view, shape[0]).matrix().replicate(1, 3);
      },
      [station, label](const Campaign& campaign, const SourcePlace& place) {
        check_station(campaign, station, place);
        check_time(campaign, label, place);
      });
  effect->add_shape(shape_parameter(table, label + ": time", "time", "s", table.number("time", 0.0),
                                    table.number("from", 0.0), table.number("to", 0.0)));
  effect->scan_by([station](const Campaign& campaign) { return event_times(campaign, station); });
  return effect;
}

/// The event is looked for between the first and the last reading of the station.
std::vector<EffectSpec> station_events(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const std::string& station : station_names(campaign)) {
    double from = std::numeric_limits<double>::infinity();
    double to = -from;
    for (const Setup& setup : campaign.setups) {
      if (station_of(setup) != station || setup.readings.time.empty()) continue;
      from = std::min(from, setup.readings.time.front());
      to = std::max(to, setup.readings.time.back());
    }
    if (!(to > from)) continue;
    specs.push_back(effect_spec(
        "station-event", {{"station", station}, {"time", 0.5 * (from + to)}, {"from", from}, {"to", to}}));
  }
  return specs;
}

std::unique_ptr<FormulaEffect> make_tool_offset(const EffectTable& table) {
  const std::string tool = table.text("tool", "add tool = \"NAME\"");
  const std::string label = "offset of tool " + tool;
  return std::make_unique<FormulaEffect>(
      EffectName{"tool-offset", TargetName::of_tool(tool), EffectDriver::called("tool", {}), "step"},
      vector_amplitudes(table, label, TargetKind::ToolOffset, "um"),
      [tool](const SetupView& view, const Eigen::VectorXd& /*shape*/) -> Eigen::MatrixXd {
        const bool carried = view.campaign.machine.tools[view.setup.tool].name == tool;
        return constant(view, carried ? 1.0 : 0.0).replicate(1, 3);
      },
      [tool](const Campaign& campaign, const SourcePlace& place) { check_tool(campaign, tool, place); });
}

std::vector<EffectSpec> tool_offsets(const Campaign& campaign) {
  std::vector<EffectSpec> specs;
  for (const std::string& tool : tools_in_use(campaign)) {
    specs.push_back(effect_spec("tool-offset", {{"tool", tool}}));
  }
  return specs;
}

}  // namespace

const EffectKind& length_scale_effect() {
  static const FormulaKind kind(
      {.kind = "length-scale",
       .summary =
           "wavelength or air index is off: every length, or those of one station, is too long by this",
       .plain = "All lengths of an instrument are too long or too short in proportion.",
       .usual_causes = "a wrong air temperature, pressure or humidity in the wavelength's compensation; a "
                       "sensor that is not where the beam is; a wavelength or scale entered wrongly",
       .source = "Edlen, Metrologia 2 (1966) 71: refractive index of air; 1 ppm per kelvin or 3.7 hPa",
       .keys = {text_key("station", "only this station; absent = all lasers", false),
                amplitude_key("amplitude_ppm", "relative error of lengths")}},
      make_length_scale, length_scales);
  return kind;
}

const EffectKind& station_drift_effect() {
  static const FormulaKind kind(
      {.kind = "station-drift",
       .summary = "a station, or all in the same way, move slowly, in proportion to time",
       .plain = "A station moves slowly while it measures.",
       .usual_causes = "a tripod or mount that settles or warms up; a magnetic base on a warm surface; an "
                       "instrument that had not reached its temperature; a soft floor",
       .source = "Schwenke et al., CIRP Annals 54 (2005): stability of stations in multilateration",
       .keys = joined({{text_key("station", "only this station; absent = all", false)},
                       vector_amplitude_keys("um_per_h", "velocity in workpiece coordinates")})},
      make_station_drift, station_drifts);
  return kind;
}

const EffectKind& station_event_effect() {
  static const FormulaKind kind(
      {.kind = "station-event",
       .summary = "a station is pushed at a certain time and stays where it then stands",
       .plain = "A station was moved at one moment and stayed where it then stood.",
       .usual_causes = "somebody touched the tripod or a cable; a door, crane or vehicle shook the floor; a "
                       "clamp slipped",
       .source = "Schwenke et al., CIRP Annals 54 (2005): stability of stations in multilateration",
       .keys = joined(
           {{text_key("station", "name of the station")},
            shape_keys("time", "s", "when it happened, campaign clock"),
            {{.key = "from_s", .help = "earliest time at which it is looked for", .plausible_max = 1e9},
             {.key = "to_s", .help = "latest time at which it is looked for", .plausible_max = 1e9}},
            vector_amplitude_keys("um", "displacement in workpiece coordinates")})},
      make_station_event, station_events);
  return kind;
}

const EffectKind& tool_offset_effect() {
  static const FormulaKind kind(
      {.kind = "tool-offset",
       .summary = "the offset of a tool (or its reflector) is not what the machine file says",
       .plain = "A tool, or its reflector, is not where the machine file says.",
       .usual_causes = "a tool length or radius entered wrongly; a reflector seated otherwise than in its "
                       "drawing; a nest that is worn or dirty",
       .source = "ISO/TR 16907:2015, 3.2 and 7.1 (functional point)",
       .keys = joined({{text_key("tool", "name of the tool")},
                       vector_amplitude_keys("um", "actual less stated offset, tool coordinates")})},
      make_tool_offset, tool_offsets);
  return kind;
}

}  // namespace volcal
