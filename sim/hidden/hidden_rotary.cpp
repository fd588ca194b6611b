#include <cmath>
#include <numbers>

#include "volcal/sim/hidden/hidden_settings.h"

namespace volcal::sim {
namespace {

AxisName rotary_axis(const HiddenSettings& settings, AxisName axis) {
  if (is_rotary(axis)) return axis;
  settings.fail(std::string("axis ") + letter_of(axis) + " is linear", "use A, B or C");
}

void worm(const HiddenSettings& settings, HiddenScene& scene) {
  const ErrorSymbol symbol = settings.symbol();
  rotary_axis(settings, symbol.axis);
  const double wave_number = 2.0 * std::numbers::pi / settings.positive("period");
  scene.machine.add_state_error(symbol, [=, a = settings.amplitude(), phase = settings.number("phase", 0.0),
                                         q = settings.position(symbol.axis)](const MachineState& state) {
    return a * std::sin(wave_number * q(state) + phase);
  });
}

void cradle_table(const HiddenSettings& settings, HiddenScene& scene) {
  const ErrorSymbol symbol = settings.symbol();
  rotary_axis(settings, symbol.axis);
  const AxisName tilting = rotary_axis(settings, settings.other_axis("by"));
  scene.machine.add_state_error(symbol,
                                [a = settings.amplitude(), phase = settings.number("phase", 0.0),
                                 turned = settings.position(symbol.axis), tilted = settings.position(tilting),
                                 home = settings.home(tilting)](const MachineState& state) {
                                  return a * std::sin(tilted(state) - home) * std::cos(turned(state) - phase);
                                });
}

}  // namespace

std::vector<HiddenKind> hidden_rotary_kinds() {
  return {
      {"worm",
       "rotary",
       "E += a sin(2 pi q / period + phase), q of a rotary axis",
       {symbol_key(), number_key("period_deg", "of a turn of the worm: 360 / teeth"),
        number_key("phase_deg", "at position 0", false)},
       "",
       "",
       worm},
      {"cradle-table",
       "rotary",
       "E += a sin(t) cos(q - phase), q of the symbol's rotary axis, t the tilt of `by` from home",
       {symbol_key(), axis_key("by", "rotary axis that tilts the other one, or is tilted by it"),
        number_key("phase_deg", "where it is largest", false)},
       "",
       "full tilt",
       cradle_table},
  };
}

}  // namespace volcal::sim
