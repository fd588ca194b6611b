// Effects of instruments, stations and tools.
#include <cmath>

#include "volcal/sim/known/known_kinds.h"

namespace volcal::sim {
namespace {

constexpr double kPush = 1.0;  // s, in which a station that is pushed moves

void known_length_scale(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.instrument.emplace_back([a = amplitude_of(settings), here = settings.where()](
                                                 const Occasion& occasion, InstrumentTruth& truth) {
    if (here(occasion)) truth.length_scale += a;
  });
}

/// The stations that the key leaves move along the effect's vector.
void displace_station(const HiddenSettings& settings, const StateNumber& driver, HiddenScene& scene) {
  scene.interference.instrument.emplace_back([full = vector_of(settings), here = settings.where(), driver](
                                                 const Occasion& occasion, InstrumentTruth& truth) {
    if (here(occasion)) truth.station += full * driver(occasion.state);
  });
}

void known_station_drift(const HiddenSettings& settings, HiddenScene& scene) {
  displace_station(
      settings, [](const MachineState& state) { return state.time; }, scene);
}

void known_station_event(const HiddenSettings& settings, HiddenScene& scene) {
  displace_station(
      settings,
      [start = settings.number("time")](const MachineState& state) {
        return 0.5 * (1.0 + std::tanh((state.time - start) / kPush));
      },
      scene);
}

void known_tool_clamping(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.tool.emplace_back(
      [full = vector_of(settings), here = settings.where()](const Occasion& occasion) -> Eigen::Vector3d {
        return here(occasion) ? full : Eigen::Vector3d::Zero();
      });
}

void known_tool_offset(const HiddenSettings& settings, HiddenScene& scene) {
  move_tool(
      vector_of(settings),
      [tool = settings.tool()](const MachineState& state) { return state.tool == tool ? 1.0 : 0.0; }, scene);
}

void known_bar_length(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.instrument.emplace_back(
      [a = amplitude_of(settings)](const Occasion& /*occasion*/, InstrumentTruth& truth) {
        truth.length_error += a;
      });
}

}  // namespace

std::vector<KnownKind> known_instrument_kinds() {
  return {
      {"ball-bar-length", known_bar_length},  {"length-scale", known_length_scale},
      {"station-drift", known_station_drift}, {"station-event", known_station_event},
      {"tool-clamping", known_tool_clamping}, {"tool-offset", known_tool_offset},
  };
}

}  // namespace volcal::sim
