#include <cmath>
#include <numbers>

#include "volcal/sim/hidden/hidden_settings.h"
#include "volcal/sim/measurement/simulated_instruments.h"

namespace volcal::sim {
namespace {

void length_scale(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.instrument.emplace_back(
      [a = settings.amplitude(), here = settings.where()](const Occasion& occasion, InstrumentTruth& truth) {
        if (here(occasion)) truth.length_scale += a;
      });
}

void air_index(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.instrument.emplace_back(
      [a = settings.amplitude(), here = settings.where(), excess = settings.excess_temperature("channel")](
          const Occasion& occasion, InstrumentTruth& truth) {
        if (here(occasion)) truth.length_scale += a * excess(occasion.state);
      });
}

void dead_path_air(const HiddenSettings& settings, HiddenScene& scene) {
  const StateNumber driver = settings.has("channel") ? settings.excess_temperature("channel") : hours;
  const double given = settings.number("dead_path", 0.0);
  scene.interference.reading.emplace_back([a = settings.amplitude(), here = settings.where(), driver, given](
                                              const Occasion& occasion, std::size_t channel, double) {
    if (channel != 0 || !here(occasion)) return 0.0;
    const double dead_path = given != 0.0 ? given : occasion.plan.truth.dead_path;
    return a * dead_path * driver(occasion.state);
  });
}

/// Moves the stations that the keys leave along `direction` by amplitude times `size`.
void move_station(const HiddenSettings& settings, const StateNumber& size, HiddenScene& scene) {
  scene.interference.instrument.emplace_back(
      [full = Eigen::Vector3d(settings.amplitude() * settings.direction(Eigen::Vector3d::Zero())),
       here = settings.where(), size](const Occasion& occasion, InstrumentTruth& truth) {
        if (here(occasion)) truth.station += full * size(occasion.state);
      });
}

void station_drift(const HiddenSettings& settings, HiddenScene& scene) {
  move_station(settings, hours, scene);
}

void station_event(const HiddenSettings& settings, HiddenScene& scene) {
  move_station(
      settings,
      [start = settings.number("time")](const MachineState& state) {
        return state.time >= start ? 1.0 : 0.0;
      },
      scene);
}

void station_swing(const HiddenSettings& settings, HiddenScene& scene) {
  const double rate = 2.0 * std::numbers::pi / settings.positive("period");
  move_station(
      settings,
      [rate, phase = settings.number("phase", 0.0)](const MachineState& state) {
        return std::sin(rate * state.time + phase);
      },
      scene);
}

void station_expansion(const HiddenSettings& settings, HiddenScene& scene) {
  move_station(settings, settings.excess_temperature("channel"), scene);
}

void tool_offset(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.tool.emplace_back(
      [error = Eigen::Vector3d(settings.amplitude() * settings.direction(Eigen::Vector3d::Zero())),
       tool = settings.tool()](const Occasion& occasion) -> Eigen::Vector3d {
        return occasion.plan.tool == tool ? error : Eigen::Vector3d::Zero();
      });
}

void tool_clamping(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.tool.emplace_back(
      [error = Eigen::Vector3d(settings.amplitude() * settings.direction(Eigen::Vector3d::Zero())),
       here = settings.where()](const Occasion& occasion) -> Eigen::Vector3d {
        return here(occasion) ? error : Eigen::Vector3d::Zero();
      });
}

void bar_length(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.instrument.emplace_back(
      [a = settings.amplitude(), here = settings.where()](const Occasion& occasion, InstrumentTruth& truth) {
        if (here(occasion)) truth.length_error += a;
      });
}

void beam_cosine(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.instrument.emplace_back(
      [a = settings.amplitude(), here = settings.where()](const Occasion& occasion, InstrumentTruth& truth) {
        if (here(occasion)) truth.beam_angle += a;
      });
}

void encoder_eccentricity(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.reading.emplace_back([a = settings.amplitude(), phase = settings.number("phase", 0.0),
                                           here = settings.where(),
                                           encoder = settings.text("encoder", "azimuth")](
                                              const Occasion& occasion, std::size_t channel, double angle) {
    const bool applies = reads_encoder(occasion.plan, channel, encoder) && here(occasion);
    return applies ? a * std::sin(angle + phase) : 0.0;
  });
}

std::vector<KeySchema> with_place(std::vector<KeySchema> keys) {
  for (KeySchema& key : place_keys()) keys.push_back(std::move(key));
  return keys;
}

}  // namespace

std::vector<HiddenKind> hidden_instrument_kinds() {
  const KeySchema direction = vector_key("direction", "in which it moves, workpiece coordinates", true);
  const KeySchema tool = text_key("tool", "the tool");
  return {
      {"length-scale", "instrument", "lengths of tracers, trackers and displacements (1 + a)", place_keys(),
       "um_per_m", "", length_scale},
      {"dead-path-air", "instrument", "length += a L0 dT, or a L0 h without a channel",
       with_place({text_key("channel", "temperature of the air", false),
                   number_key("dead_path_mm", "L0; absent = the setup's true dead path", false)}),
       "um_per_m", "K or hour", dead_path_air},
      {"station-drift", "instrument", "station += a h direction", with_place({direction}), "um", "hour",
       station_drift},
      {"station-event", "instrument", "station += a direction from `time` on",
       with_place({direction, number_key("time_s", "of the event")}), "um", "", station_event},
      {"tool-offset", "instrument", "tool offset += a direction", {tool, direction}, "um", "", tool_offset},
      {"tool-clamping", "instrument", "tool offset += a direction in the setups that the keys leave",
       with_place({direction}), "um", "", tool_clamping},
      {"bar-length", "instrument", "length of ball-bars += a", place_keys(), "um", "", bar_length},
      {"beam-cosine", "instrument", "beam of displacements turned by a from their path", place_keys(), "mrad",
       "", beam_cosine},
      {"encoder-eccentricity", "instrument", "angle of a tracker += a sin(angle + phase)",
       with_place({{"encoder", KeyType::Text, false, "absent = azimuth", {"azimuth", "elevation"}},
                   number_key("phase_deg", "absent = 0", false)}),
       "urad", "", encoder_eccentricity},
      {"air-index", "unlisted", "lengths of tracers, trackers and displacements (1 + a dT)",
       with_place({text_key("channel", "temperature of the air")}), "um_per_m", "K", air_index},
      {"station-swing", "unlisted", "station += a sin(2 pi t / period + phase) direction",
       with_place(
           {direction, number_key("period_s", "of the swing"), number_key("phase_deg", "at time 0", false)}),
       "um", "", station_swing},
      {"station-expansion", "unlisted", "station += a dT direction",
       with_place({direction, text_key("channel", "temperature of its stand")}), "um", "K",
       station_expansion},
  };
}

}  // namespace volcal::sim
