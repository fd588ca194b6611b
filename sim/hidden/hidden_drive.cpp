#include <cmath>
#include <numbers>

#include "volcal/sim/hidden/hidden_settings.h"

namespace volcal::sim {
namespace {

void reversal(const HiddenSettings& settings, HiddenScene& scene) {
  const ErrorSymbol symbol = settings.symbol();
  const double half = 0.5 * settings.amplitude();
  scene.machine.add_state_error(symbol, [half, k = index_of(symbol.axis)](const MachineState& state) {
    return half * state.direction[k];
  });
}

void common_reversal(const HiddenSettings& settings, HiddenScene& scene) {
  const double half = 0.5 * settings.amplitude();
  for (const AxisName axis : settings.linear_axes("axes")) {
    scene.machine.add_state_error(
        positioning_of(axis),
        [half, k = index_of(axis)](const MachineState& state) { return half * state.direction[k]; });
  }
}

void reversal_position(const HiddenSettings& settings, HiddenScene& scene) {
  const ErrorSymbol symbol = settings.symbol();
  const StateNumber u = settings.share(symbol.axis);
  const double half = 0.5 * settings.amplitude();
  scene.machine.add_state_error(symbol, [half, u, k = index_of(symbol.axis)](const MachineState& state) {
    return half * u(state) * state.direction[k];
  });
}

void reversal_spike(const HiddenSettings& settings, HiddenScene& scene) {
  const ErrorSymbol symbol = settings.symbol();
  if (is_rotary(symbol.axis)) settings.fail(symbol.name() + " is of a rotary axis", "use a linear axis");
  scene.machine.add_state_error(
      symbol, [half = 0.5 * settings.amplitude(), length = settings.positive("length"),
               k = index_of(symbol.axis)](const MachineState& state) {
        return half * state.direction[k] * std::exp(-state.since_reversal[k] / length);
      });
}

void direction_temperature(const HiddenSettings& settings, HiddenScene& scene) {
  const ErrorSymbol symbol = settings.symbol();
  scene.machine.add_state_error(
      symbol, [half = 0.5 * settings.amplitude(), excess = settings.excess_temperature("channel"),
               k = index_of(symbol.axis)](const MachineState& state) {
        return half * state.direction[k] * excess(state);
      });
}

void periodic(const HiddenSettings& settings, HiddenScene& scene) {
  const ErrorSymbol symbol = settings.symbol();
  if (is_rotary(symbol.axis)) settings.fail(symbol.name() + " is of a rotary axis", "use a linear axis");
  const double wave_number = 2.0 * std::numbers::pi / settings.positive("period");
  const double phase = settings.number("phase", 0.0);
  const double second = settings.number("second_harmonic", 0.0);
  const double third = settings.number("third_harmonic", 0.0);
  scene.machine.add_state_error(
      symbol, [=, a = settings.amplitude(), q = settings.position(symbol.axis)](const MachineState& state) {
        const double angle = wave_number * q(state) + phase;
        return a * (std::sin(angle) + second * std::sin(2.0 * angle) + third * std::sin(3.0 * angle));
      });
}

void screw_heating(const HiddenSettings& settings, HiddenScene& scene) {
  const AxisName axis = settings.linear_axis("axis");
  const double time_constant = settings.positive("time_constant");
  scene.machine.add_state_error(positioning_of(axis), [a = settings.amplitude(), time_constant,
                                                       u = settings.share(axis)](const MachineState& state) {
    return a * u(state) * (1.0 - std::exp(-state.time / time_constant));
  });
}

void servo_mismatch(const HiddenSettings& settings, HiddenScene& scene) {
  constexpr double kMetrePerMinute = 1.0 / 60.0;
  const AxisName axis = settings.linear_axis("axis");
  const double lag = settings.amplitude() / kMetrePerMinute;
  scene.machine.add_state_error(positioning_of(axis), [lag, k = index_of(axis)](const MachineState& state) {
    return -lag * state.velocity[k];
  });
}

std::vector<KeySchema> periodic_keys() {
  return {symbol_key(), number_key("period_mm", "of the fundamental"),
          number_key("phase_deg", "at machine position 0", false),
          number_key("second_harmonic", "as a share of the fundamental", false),
          number_key("third_harmonic", "as a share of the fundamental", false)};
}

}  // namespace

std::vector<HiddenKind> hidden_drive_kinds() {
  const std::string wave =
      "E += a [sin w + second_harmonic sin 2w + third_harmonic sin 3w], "
      "w = 2 pi q / period + phase";
  return {
      {"reversal", "drive", "E += d a/2, d of the symbol's axis", {symbol_key()}, "", "", reversal},
      {"common-reversal",
       "drive",
       "positioning of each axis += d a/2, d of that axis",
       {text_key("axes", "\"X Y Z\"")},
       "um",
       "",
       common_reversal},
      {"reversal-position",
       "drive",
       "E += d u a/2, d and u of the symbol's axis",
       {symbol_key()},
       "",
       "full travel",
       reversal_position},
      {"reversal-spike",
       "drive",
       "E += d a/2 exp(-s / length), s travelled since the axis turned round",
       {symbol_key(), number_key("length_mm", "in which it dies away")},
       "",
       "",
       reversal_spike},
      {"direction-temperature",
       "drive",
       "E += d dT a/2, d of the symbol's axis",
       {symbol_key(), text_key("channel", "temperature channel")},
       "",
       "K",
       direction_temperature},
      {"screw-lead", "drive", wave + " (the lead of a ball screw)", periodic_keys(), "", "", periodic},
      {"encoder-subdivision", "drive", wave + " (the signal period of a scale)", periodic_keys(), "", "",
       periodic},
      {"screw-heating",
       "drive",
       "positioning += a u (1 - exp(-t / time_constant)) since the campaign's start",
       {axis_key("axis", "its screw"), number_key("time_constant_s", "of the heating")},
       "um",
       "full travel",
       screw_heating},
      {"servo-mismatch",
       "instrument",
       "positioning -= a v / (1 m/min), v the axis' velocity while moving",
       {axis_key("axis", "that lags behind the others")},
       "um",
       "m/min",
       servo_mismatch},
  };
}

}  // namespace volcal::sim
