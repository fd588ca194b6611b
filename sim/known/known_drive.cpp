// Effects of drives and scales: reversals, and what repeats with a screw, a rack, a worm or a scale.
#include <cmath>
#include <numbers>
#include <sstream>

#include "volcal/sim/known/known_kinds.h"

namespace volcal::sim {
namespace {

constexpr double kUsualLead = 10e-3;    // m
constexpr double kUsualSignal = 1e-3;   // m
constexpr double kUsualRack = 125e-3;   // m
constexpr double kUsualLength = 10e-3;  // m
constexpr double kRingPeriod = 2.0 * std::numbers::pi;
constexpr double kUsualTooth = kRingPeriod / 90.0;

/// Of the key `symbols`, "EXX EYY".
std::vector<ErrorSymbol> symbols_of(const HiddenSettings& settings) {
  constexpr const char* kRemedy = "write symbols = \"EXX EYY EZZ\"";
  std::istringstream words(settings.text("symbols", ""));
  std::vector<ErrorSymbol> symbols;
  for (std::string word; words >> word;) {
    const auto symbol = ErrorSymbol::parse(word);
    if (!symbol) settings.fail("\"" + word + "\" is not an error motion", kRemedy);
    symbols.push_back(*symbol);
  }
  if (symbols.empty()) settings.fail("it names no error motion", kRemedy);
  return symbols;
}

/// Half of the amplitude towards +, half taken off towards -.
StateNumber half_by_approach(AxisName axis) {
  return [d = approach_of(axis)](const MachineState& state) { return 0.5 * d(state); };
}

void known_reversal(const HiddenSettings& settings, HiddenScene& scene) {
  add_motion(settings, half_by_approach(settings.symbol().axis), scene);
}

void known_common_reversal(const HiddenSettings& settings, HiddenScene& scene) {
  for (const ErrorSymbol symbol : symbols_of(settings))
    add_motion(settings, symbol, half_by_approach(symbol.axis), scene);
}

/// A reversal that changes in proportion to something.
void add_growing_reversal(const HiddenSettings& settings, const StateNumber& with, HiddenScene& scene) {
  add_motion(settings, product_of(half_by_approach(settings.symbol().axis), with), scene);
}

void known_position_reversal(const HiddenSettings& settings, HiddenScene& scene) {
  add_growing_reversal(settings, from_home(settings, settings.symbol().axis), scene);
}

/// Of the axis' position from home, with the amplitudes `cos` and `sin`.
StateNumber wave_of(const HiddenSettings& settings, double usual_period) {
  return [wave_number = 2.0 * std::numbers::pi / settings.positive("period", usual_period),
          of_cosine = settings.number("cos", 0.0), of_sine = settings.number("sin", 0.0),
          q = from_home(settings, settings.symbol().axis)](const MachineState& state) {
    const double angle = wave_number * q(state);
    return of_cosine * std::cos(angle) + of_sine * std::sin(angle);
  };
}

void add_wave(const HiddenSettings& settings, double usual_period, HiddenScene& scene) {
  scene.machine.add_state_error(settings.symbol(), wave_of(settings, usual_period));
}

void known_lead_error(const HiddenSettings& settings, HiddenScene& scene) {
  add_wave(settings, kUsualLead, scene);
}

void known_subdivision(const HiddenSettings& settings, HiddenScene& scene) {
  add_wave(settings, kUsualSignal, scene);
}

void known_curved_reversal(const HiddenSettings& settings, HiddenScene& scene) {
  const StateNumber q = from_home(settings, settings.symbol().axis);
  add_growing_reversal(settings, product_of(q, q), scene);
}

void known_thermal_reversal(const HiddenSettings& settings, HiddenScene& scene) {
  add_growing_reversal(settings, settings.excess_temperature("temperature"), scene);
}

void known_pre_travel(const HiddenSettings& settings, HiddenScene& scene) {
  add_growing_reversal(
      settings,
      [length = settings.positive("length", kUsualLength), k = index_of(settings.symbol().axis)](
          const MachineState& state) { return std::exp(-state.since_reversal[k] / length); },
      scene);
}

void known_growing_lead_error(const HiddenSettings& settings, HiddenScene& scene) {
  const ErrorSymbol symbol = settings.symbol();
  scene.machine.add_state_error(symbol,
                                product_of(from_home(settings, symbol.axis), wave_of(settings, kUsualLead)));
}

void known_rack_error(const HiddenSettings& settings, HiddenScene& scene) {
  add_wave(settings, kUsualRack, scene);
}

void known_worm_error(const HiddenSettings& settings, HiddenScene& scene) {
  add_wave(settings, kUsualTooth, scene);
}

void known_ring_eccentricity(const HiddenSettings& settings, HiddenScene& scene) {
  add_wave(settings, kRingPeriod, scene);
}

/// How far an axis is behind, of an effect whose amplitude is a time or a displacement at full speed.
StateNumber behind(const HiddenSettings& settings, AxisName axis, double share) {
  return [a = share * amplitude_of(settings), k = index_of(axis),
          timed = settings.has("by")](const MachineState& state) {
    const double velocity = state.velocity[k];
    if (velocity == 0.0) return 0.0;
    return -a * (timed ? velocity : velocity / state.feed());
  };
}

void known_following_error(const HiddenSettings& settings, HiddenScene& scene) {
  const AxisName axis = settings.linear_axis("axis");
  scene.machine.add_state_error(positioning_of(axis), behind(settings, axis, 1.0));
}

/// The first axis is late on circles that both make, by all of the time between the two; the amplitude of a
/// displacement is half of what it is late.
void known_servo_mismatch(const HiddenSettings& settings, HiddenScene& scene) {
  const AxisName first = settings.linear_axis("axis"), second = settings.linear_axis("second_axis");
  const double share = settings.has("by") ? 1.0 : 2.0;
  scene.machine.add_state_error(positioning_of(first), [late = behind(settings, first, share),
                                                        one = index_of(first),
                                                        other = index_of(second)](const MachineState& state) {
    constexpr double kOnTheirCircle = 1.0 - 1e-9;  // no third axis moves
    const bool both = std::hypot(state.velocity[one], state.velocity[other]) >= kOnTheirCircle * state.feed();
    return both ? late(state) : 0.0;
  });
}

}  // namespace

std::vector<KnownKind> known_drive_kinds() {
  return {
      {"common-reversal", known_common_reversal},
      {"curved-reversal", known_curved_reversal},
      {"encoder-subdivision", known_subdivision},
      {"following-error", known_following_error},
      {"growing-lead-error", known_growing_lead_error},
      {"lead-error", known_lead_error},
      {"position-reversal", known_position_reversal},
      {"pre-travel", known_pre_travel},
      {"rack-error", known_rack_error},
      {"reversal", known_reversal},
      {"ring-eccentricity", known_ring_eccentricity},
      {"servo-mismatch", known_servo_mismatch},
      {"thermal-reversal", known_thermal_reversal},
      {"worm-error", known_worm_error},
  };
}

}  // namespace volcal::sim
