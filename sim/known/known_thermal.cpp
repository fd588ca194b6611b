// Effects of temperatures and of warming up.
#include <cmath>

#include "volcal/sim/known/known_kinds.h"

namespace volcal::sim {
namespace {

constexpr double kUsualHeating = 1800.0;  // s, where a model states no time constant
constexpr double kUsualGrowth = 3600.0;   // s
constexpr double kUsualLag = 3600.0;      // s
constexpr double kUsualCore = 1800.0;     // s

StateNumber warmed_up(const HiddenSettings& settings, double usual_time_constant) {
  return [tau = settings.positive("time_constant", usual_time_constant)](const MachineState& state) {
    return 1.0 - std::exp(-state.time / tau);
  };
}

StateNumber late_excess(const HiddenSettings& settings) {
  return [tau = settings.positive("time_constant", kUsualLag),
          channel = settings.channel("temperature")](const MachineState& state) {
    return state.settled ? 0.0 : channel.lagged(state.time, tau) - kReferenceTemperature;
  };
}

/// The scale of an axis grows from home.
void add_scale(const HiddenSettings& settings, AxisName axis, const StateNumber& driver, HiddenScene& scene) {
  add_motion(settings, positioning_of(axis), product_of(driver, from_home(settings, axis)), scene);
}

void known_common_expansion(const HiddenSettings& settings, HiddenScene& scene) {
  for (const AxisName axis : settings.linear_axes("axes"))
    add_scale(settings, axis, settings.excess_temperature("temperature"), scene);
}

void known_common_growth(const HiddenSettings& settings, HiddenScene& scene) {
  for (const AxisName axis : settings.linear_axes("axes"))
    add_scale(settings, axis, warmed_up(settings, kUsualGrowth), scene);
}

void known_screw_heating(const HiddenSettings& settings, HiddenScene& scene) {
  add_scale(settings, settings.linear_axis("axis"), warmed_up(settings, kUsualHeating), scene);
}

void known_scale_expansion(const HiddenSettings& settings, HiddenScene& scene) {
  add_scale(settings, settings.linear_axis("axis"), settings.excess_temperature("temperature"), scene);
}

void known_thermal_drift(const HiddenSettings& settings, HiddenScene& scene) {
  add_motion(settings, settings.excess_temperature("temperature"), scene);
}

void known_lagged_temperature(const HiddenSettings& settings, HiddenScene& scene) {
  add_motion(settings, late_excess(settings), scene);
}

void known_spindle_growth(const HiddenSettings& settings, HiddenScene& scene) {
  move_tool(vector_of(settings), warmed_up(settings, kUsualHeating), scene);
}

void known_tool_expansion(const HiddenSettings& settings, HiddenScene& scene) {
  move_tool(vector_of(settings), settings.excess_temperature("temperature"), scene);
}

void known_lagged_expansion(const HiddenSettings& settings, HiddenScene& scene) {
  move_tool(vector_of(settings), late_excess(settings), scene);
}

void known_squareness_drift(const HiddenSettings& settings, HiddenScene& scene) {
  StateNumber driver = [](const MachineState& state) { return state.time; };
  if (settings.has("temperature")) driver = settings.excess_temperature("temperature");
  scene.machine.add_location_change(
      settings.location_symbol(),
      [a = amplitude_of(settings), driver](const MachineState& state) { return a * driver(state); });
}

/// How much warmer the skin is than the core behind it.
StateNumber ahead_of_core(const HiddenSettings& settings) {
  return [tau = settings.positive("time_constant", kUsualCore),
          channel = settings.channel("temperature")](const MachineState& state) {
    return state.settled ? 0.0 : state.temperature.at(channel.name) - channel.lagged(state.time, tau);
  };
}

void known_temperature_rate(const HiddenSettings& settings, HiddenScene& scene) {
  add_motion(settings, ahead_of_core(settings), scene);
}

void known_tool_rate(const HiddenSettings& settings, HiddenScene& scene) {
  move_tool(vector_of(settings), ahead_of_core(settings), scene);
}

}  // namespace

std::vector<KnownKind> known_thermal_kinds() {
  return {
      {"common-expansion", known_common_expansion}, {"common-growth", known_common_growth},
      {"lagged-expansion", known_lagged_expansion}, {"lagged-temperature", known_lagged_temperature},
      {"scale-expansion", known_scale_expansion},   {"screw-heating", known_screw_heating},
      {"spindle-growth", known_spindle_growth},     {"squareness-drift", known_squareness_drift},
      {"temperature-rate", known_temperature_rate}, {"thermal-drift", known_thermal_drift},
      {"tool-expansion", known_tool_expansion},     {"tool-temperature-rate", known_tool_rate},
  };
}

}  // namespace volcal::sim
