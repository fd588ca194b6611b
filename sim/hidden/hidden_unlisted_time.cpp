/// Shapes against time and temperature that no catalogue is meant to hold.

#include <cmath>
#include <numbers>

#include "volcal/sim/hidden/hidden_settings.h"

namespace volcal::sim {
namespace {

void root_time(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.add_state_error(
      settings.symbol(), [a = settings.amplitude(), u = settings.share_or_one("by")](
                             const MachineState& state) { return a * u(state) * std::sqrt(hours(state)); });
}

void heated_zone(const HiddenSettings& settings, HiddenScene& scene) {
  const AxisName axis = settings.linear_axis("axis");
  const double centre = settings.number("centre");
  const double width = settings.positive("width") * std::numbers::sqrt2;
  const double time_constant = settings.positive("time_constant");
  const auto strained = [=](double q) { return 0.5 * std::erf((q - centre) / width); };
  const double at_home = strained(settings.home(axis));
  scene.machine.add_state_error(
      positioning_of(axis),
      [=, a = settings.amplitude(), q = settings.position(axis)](const MachineState& state) {
        return a * (strained(q(state)) - at_home) * (1.0 - std::exp(-state.time / time_constant));
      });
}

void gradient_bending(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.add_state_error(settings.symbol(),
                                [a = settings.amplitude(), warm = settings.excess_temperature("channel"),
                                 cold = settings.excess_temperature("minus"),
                                 u = settings.share_or_one("by")](const MachineState& state) {
                                  return a * (warm(state) - cold(state)) * u(state);
                                });
}

void temperature_squared(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.add_state_error(settings.symbol(),
                                [a = settings.amplitude(), excess = settings.excess_temperature("channel"),
                                 u = settings.share_or_one("by")](const MachineState& state) {
                                  return a * u(state) * excess(state) * excess(state);
                                });
}

}  // namespace

std::vector<HiddenKind> hidden_unlisted_time_kinds() {
  const KeySchema channel = text_key("channel", "temperature channel");
  const KeySchema by = axis_key("by", "grows along this axis", false);
  return {
      {"root-time",
       "unlisted",
       "E += a sqrt(h), times u of `by` if given",
       {symbol_key(), by},
       "",
       "root of an hour",
       root_time},
      {"heated-zone",
       "unlisted",
       "positioning += a [g(q) - g(home)] (1 - exp(-t / time_constant)), g = erf((q - centre) / (width sqrt "
       "2)) "
       "/ 2",
       {axis_key("axis", "its screw"), number_key("centre_mm", "of the zone"),
        number_key("width_mm", "of it"), number_key("time_constant_s", "of the heating")},
       "um",
       "",
       heated_zone},
      {"gradient-bending",
       "unlisted",
       "E += a (T - T of `minus`), times u of `by` if given",
       {symbol_key(), channel, text_key("minus", "the other temperature channel"), by},
       "",
       "K",
       gradient_bending},
      {"temperature-squared",
       "unlisted",
       "E += a dT^2, times u of `by` if given",
       {symbol_key(), channel, by},
       "",
       "K^2",
       temperature_squared},
  };
}

}  // namespace volcal::sim
