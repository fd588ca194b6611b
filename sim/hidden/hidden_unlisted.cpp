/// Shapes along positions that no catalogue is meant to hold.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "volcal/sim/hidden/hidden_settings.h"

namespace volcal::sim {
namespace {

AxisName linear_axis_of_symbol(const HiddenSettings& settings) {
  const ErrorSymbol symbol = settings.symbol();
  if (is_rotary(symbol.axis)) settings.fail(symbol.name() + " is of a rotary axis", "use a linear axis");
  return symbol.axis;
}

/// The axis `by`, or the symbol's own.
AxisName axis_by(const HiddenSettings& settings) {
  const AxisName axis = settings.has("by") ? settings.axis("by") : settings.symbol().axis;
  if (is_rotary(axis)) settings.fail("the axis is rotary", "use a linear axis");
  return axis;
}

/// Signed direction of approach of the symbol's axis, times half the amplitude.
StateNumber half_by_direction(const HiddenSettings& settings) {
  return [half = 0.5 * settings.amplitude(), k = index_of(settings.symbol().axis)](
             const MachineState& state) { return half * state.direction[k]; };
}

void backlash_kink(const HiddenSettings& settings, HiddenScene& scene) {
  const AxisName axis = linear_axis_of_symbol(settings);
  const double travel = settings.travel(axis);
  scene.machine.add_state_error(settings.symbol(),
                                [=, half = half_by_direction(settings), q = settings.position(axis),
                                 kink = settings.number("position")](const MachineState& state) {
                                  return half(state) * std::max(0.0, q(state) - kink) / travel;
                                });
}

void triangle_wave(const HiddenSettings& settings, HiddenScene& scene) {
  const double period = settings.positive("period");
  const double shift = settings.number("phase", 0.0) / (2.0 * std::numbers::pi);
  scene.machine.add_state_error(
      settings.symbol(),
      [=, a = settings.amplitude(), q = settings.position(axis_by(settings))](const MachineState& state) {
        const double turns = q(state) / period + shift;
        return a * (4.0 * std::abs(turns - std::floor(turns + 0.5)) - 1.0);
      });
}

void cross_wave(const HiddenSettings& settings, HiddenScene& scene) {
  const double wave_number = 2.0 * std::numbers::pi / settings.positive("period");
  const AxisName by = settings.other_axis("by");
  if (is_rotary(by)) settings.fail("the axis is rotary", "use a linear axis");
  scene.machine.add_state_error(
      settings.symbol(),
      [=, a = settings.amplitude(), phase = settings.number("phase", 0.0), q = settings.position(by)](
          const MachineState& state) { return a * std::sin(wave_number * q(state) + phase); });
}

void local_bump(const HiddenSettings& settings, HiddenScene& scene) {
  const AxisName own = linear_axis_of_symbol(settings);
  const AxisName by = settings.other_axis("by");
  if (is_rotary(by)) settings.fail("the axis is rotary", "use a linear axis");
  const auto from_centre = [&](AxisName axis, const std::string& prefix) -> StateNumber {
    return [q = settings.position(axis), centre = settings.number(prefix + "centre"),
            width = settings.positive(prefix + "width")](const MachineState& state) {
      return (q(state) - centre) / width;
    };
  };
  scene.machine.add_state_error(settings.symbol(), [a = settings.amplitude(), s = from_centre(own, ""),
                                                    t = from_centre(by, "by_")](const MachineState& state) {
    return a * std::exp(-0.5 * (s(state) * s(state) + t(state) * t(state)));
  });
}

void position_step(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.add_state_error(
      settings.symbol(),
      [a = settings.amplitude(), q = settings.position(axis_by(settings)),
       step = settings.number("position")](const MachineState& state) { return q(state) > step ? a : 0.0; });
}

void cross_kink(const HiddenSettings& settings, HiddenScene& scene) {
  const AxisName by = settings.other_axis("by");
  if (is_rotary(by)) settings.fail("the axis is rotary", "use a linear axis");
  scene.machine.add_state_error(
      settings.symbol(), [a = settings.amplitude(), travel = settings.travel(by), q = settings.position(by),
                          kink = settings.number("position")](const MachineState& state) {
        return a * std::max(0.0, q(state) - kink) / travel;
      });
}

void direction_memory(const HiddenSettings& settings, HiddenScene& scene) {
  const ErrorSymbol symbol = settings.symbol();
  linear_axis_of_symbol(settings);
  const double length = settings.positive("length");
  const double lag = settings.number("time_constant", 0.0);
  scene.machine.add_state_error(
      symbol, [=, half = half_by_direction(settings), k = index_of(symbol.axis)](const MachineState& state) {
        const double memory = length + lag * std::abs(state.velocity[k]);
        return half(state) * (1.0 - 2.0 * std::exp(-state.since_reversal[k] / memory));
      });
}

}  // namespace

std::vector<HiddenKind> hidden_unlisted_kinds() {
  const KeySchema by = axis_key("by", "axis on whose position it depends");
  const KeySchema own_or_by = axis_key("by", "on whose position it depends; absent = the symbol's", false);
  const KeySchema phase = number_key("phase_deg", "at machine position 0", false);
  const KeySchema position = number_key("position_mm", "where it begins");
  return {
      {"backlash-kink",
       "unlisted",
       "E += d a/2 max(0, q - position) / travel",
       {symbol_key(), position},
       "",
       "full travel",
       backlash_kink},
      {"triangle-wave",
       "unlisted",
       "E += a tri(q / period + phase / 360 deg), tri from -1 at whole to +1 at half numbers",
       {symbol_key(), number_key("period_mm", "of the wave"), phase, own_or_by},
       "",
       "",
       triangle_wave},
      {"cross-wave",
       "unlisted",
       "E += a sin(2 pi q / period + phase), q of another axis than the symbol's",
       {symbol_key(), by, number_key("period_mm", "of the wave"), phase},
       "",
       "",
       cross_wave},
      {"local-bump",
       "unlisted",
       "E += a exp(-((q - centre) / width)^2 / 2 - ((p - by_centre) / by_width)^2 / 2), p of the axis `by`",
       {symbol_key(), number_key("centre_mm", "along the symbol's axis"),
        number_key("width_mm", "along the symbol's axis"), by, number_key("by_centre_mm", "along `by`"),
        number_key("by_width_mm", "along `by`")},
       "",
       "",
       local_bump},
      {"position-step",
       "unlisted",
       "E += a where q > position",
       {symbol_key(), position, own_or_by},
       "",
       "",
       position_step},
      {"cross-kink",
       "unlisted",
       "E += a max(0, q - position) / travel, q of another axis than the symbol's",
       {symbol_key(), by, position},
       "",
       "full travel",
       cross_kink},
      {"direction-memory",
       "unlisted",
       "E += d a/2 (1 - 2 exp(-s / (length + |v| time_constant))), s travelled since the axis turned round",
       {symbol_key(), number_key("length_mm", "in which the new direction is taken up, standing"),
        number_key("time_constant_s", "longer when moving at v", false)},
       "",
       "",
       direction_memory},
  };
}

}  // namespace volcal::sim
