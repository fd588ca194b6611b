// Effects of a model file as a truth machine has them. Keys are those of model files: "temperature" names a
// channel, amplitudes are per metre, per kelvin or per second, positions count from home.
#include <cmath>
#include <numbers>
#include <sstream>

#include "volcal/sim/hidden/hidden_settings.h"
#include "volcal/sim/known_errors.h"

namespace volcal::sim {
namespace {

constexpr double kUsualHeating = 1800.0;  // s, where a model states no time constant
constexpr double kUsualLag = 3600.0;      // s
constexpr double kPush = 1.0;             // s, in which a station that is pushed moves
constexpr double kUsualLead = 10e-3;      // m
constexpr double kUsualSignal = 1e-3;     // m

StateNumber from_home(const HiddenSettings& settings, AxisName axis) {
  return [k = index_of(axis), home = settings.home(axis)](const MachineState& state) {
    return state.position[k] - home;
  };
}

StateNumber direction_of_approach(AxisName axis) {
  return [k = index_of(axis)](const MachineState& state) { return static_cast<double>(state.direction[k]); };
}

double amplitude_of(const HiddenSettings& settings) { return settings.number("amplitude", 0.0); }

Eigen::Vector3d vector_of(const HiddenSettings& settings) {
  return {settings.number("x", 0.0), settings.number("y", 0.0), settings.number("z", 0.0)};
}

/// The tool's offset grows along a vector as `driver` says.
void move_tool(const Eigen::Vector3d& full, const StateNumber& driver, HiddenScene& scene) {
  scene.interference.tool.emplace_back(
      [full, driver](const Occasion& occasion) -> Eigen::Vector3d { return full * driver(occasion.state); });
}

StateNumber warmed_up(const HiddenSettings& settings) {
  return [tau = settings.positive("time_constant", kUsualHeating)](const MachineState& state) {
    return 1.0 - std::exp(-state.time / tau);
  };
}

StateNumber late_excess(const HiddenSettings& settings) {
  return [tau = settings.positive("time_constant", kUsualLag),
          channel = settings.channel("temperature")](const MachineState& state) {
    return state.settled ? 0.0 : channel.lagged(state.time, tau) - kReferenceTemperature;
  };
}

void known_reversal(const HiddenSettings& settings, HiddenScene& scene) {
  const ErrorSymbol symbol = settings.symbol();
  scene.machine.add_state_error(symbol,
                                [half = 0.5 * amplitude_of(settings), d = direction_of_approach(symbol.axis)](
                                    const MachineState& state) { return half * d(state); });
}

/// Of the key `symbols`, "EXX EYY".
std::vector<ErrorSymbol> symbols_of(const HiddenSettings& settings) {
  constexpr const char* kRemedy = "write symbols = \"EXX EYY EZZ\"";
  std::istringstream words(settings.text("symbols", ""));
  std::vector<ErrorSymbol> symbols;
  for (std::string word; words >> word;) {
    const auto symbol = ErrorSymbol::parse(word);
    if (!symbol) settings.fail("\"" + word + "\" is no error motion", kRemedy);
    symbols.push_back(*symbol);
  }
  if (symbols.empty()) settings.fail("it names no error motion", kRemedy);
  return symbols;
}

void known_common_reversal(const HiddenSettings& settings, HiddenScene& scene) {
  for (const ErrorSymbol symbol : symbols_of(settings)) {
    scene.machine.add_state_error(
        symbol, [half = 0.5 * amplitude_of(settings), d = direction_of_approach(symbol.axis)](
                    const MachineState& state) { return half * d(state); });
  }
}

void known_common_expansion(const HiddenSettings& settings, HiddenScene& scene) {
  for (const AxisName axis : settings.linear_axes("axes")) {
    scene.machine.add_state_error(
        positioning_of(axis),
        [a = amplitude_of(settings), excess = settings.excess_temperature("temperature"),
         q = from_home(settings, axis)](const MachineState& state) { return a * excess(state) * q(state); });
  }
}

void known_common_growth(const HiddenSettings& settings, HiddenScene& scene) {
  constexpr double kUsualGrowth = 3600.0;  // s
  for (const AxisName axis : settings.linear_axes("axes")) {
    scene.machine.add_state_error(
        positioning_of(axis),
        [a = amplitude_of(settings), tau = settings.positive("time_constant", kUsualGrowth),
         q = from_home(settings, axis)](const MachineState& state) {
          return a * q(state) * (1.0 - std::exp(-state.time / tau));
        });
  }
}

void known_position_reversal(const HiddenSettings& settings, HiddenScene& scene) {
  const ErrorSymbol symbol = settings.symbol();
  scene.machine.add_state_error(symbol,
                                [half = 0.5 * amplitude_of(settings), d = direction_of_approach(symbol.axis),
                                 q = from_home(settings, symbol.axis)](const MachineState& state) {
                                  return half * d(state) * q(state);
                                });
}

void add_wave(const HiddenSettings& settings, double usual_period, HiddenScene& scene) {
  const ErrorSymbol symbol = settings.symbol();
  scene.machine.add_state_error(
      symbol, [wave_number = 2.0 * std::numbers::pi / settings.positive("period", usual_period),
               of_cosine = settings.number("cos", 0.0), of_sine = settings.number("sin", 0.0),
               q = from_home(settings, symbol.axis)](const MachineState& state) {
        const double angle = wave_number * q(state);
        return of_cosine * std::cos(angle) + of_sine * std::sin(angle);
      });
}

void known_lead_error(const HiddenSettings& settings, HiddenScene& scene) {
  add_wave(settings, kUsualLead, scene);
}

void known_subdivision(const HiddenSettings& settings, HiddenScene& scene) {
  add_wave(settings, kUsualSignal, scene);
}

void known_screw_heating(const HiddenSettings& settings, HiddenScene& scene) {
  const AxisName axis = settings.linear_axis("axis");
  scene.machine.add_state_error(
      positioning_of(axis),
      [a = amplitude_of(settings), q = from_home(settings, axis),
       growth = warmed_up(settings)](const MachineState& state) { return a * q(state) * growth(state); });
}

void known_scale_expansion(const HiddenSettings& settings, HiddenScene& scene) {
  const AxisName axis = settings.linear_axis("axis");
  scene.machine.add_state_error(
      positioning_of(axis), [a = amplitude_of(settings), q = from_home(settings, axis),
                             excess = settings.excess_temperature("temperature")](const MachineState& state) {
        return a * excess(state) * q(state);
      });
}

void known_thermal_drift(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.add_state_error(
      settings.symbol(), [a = amplitude_of(settings), excess = settings.excess_temperature("temperature")](
                             const MachineState& state) { return a * excess(state); });
}

void known_lagged_temperature(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.add_state_error(settings.symbol(),
                                [a = amplitude_of(settings), excess = late_excess(settings)](
                                    const MachineState& state) { return a * excess(state); });
}

void known_spindle_growth(const HiddenSettings& settings, HiddenScene& scene) {
  move_tool(vector_of(settings), warmed_up(settings), scene);
}

void known_tool_expansion(const HiddenSettings& settings, HiddenScene& scene) {
  move_tool(vector_of(settings), settings.excess_temperature("temperature"), scene);
}

void known_lagged_expansion(const HiddenSettings& settings, HiddenScene& scene) {
  move_tool(vector_of(settings), late_excess(settings), scene);
}

void known_tool_offset(const HiddenSettings& settings, HiddenScene& scene) {
  move_tool(
      vector_of(settings),
      [tool = settings.tool()](const MachineState& state) { return state.tool == tool ? 1.0 : 0.0; }, scene);
}

void known_tool_load(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.add_state_error(
      settings.symbol(), [a = amplitude_of(settings), tool = settings.tool()](const MachineState& state) {
        return state.tool == tool ? a : 0.0;
      });
}

void known_squareness_drift(const HiddenSettings& settings, HiddenScene& scene) {
  StateNumber driver = [](const MachineState& state) { return state.time; };
  if (settings.has("temperature")) driver = settings.excess_temperature("temperature");
  scene.machine.add_location_change(
      settings.location_symbol(),
      [a = amplitude_of(settings), driver](const MachineState& state) { return a * driver(state); });
}

void known_axis_coupling(const HiddenSettings& settings, HiddenScene& scene) {
  const std::string shape = settings.text("shape", "linear");
  const double power = shape == "cubic" ? 3.0 : shape == "quadratic" ? 2.0 : 1.0;
  scene.machine.add_state_error(
      settings.symbol(), [a = amplitude_of(settings), q = from_home(settings, settings.other_axis("axis")),
                          power](const MachineState& state) { return a * std::pow(q(state), power); });
}

void known_product_coupling(const HiddenSettings& settings, HiddenScene& scene) {
  scene.machine.add_state_error(
      settings.symbol(), [a = amplitude_of(settings), first = from_home(settings, settings.axis("axis")),
                          second = from_home(settings, settings.axis("second_axis"))](
                             const MachineState& state) { return a * first(state) * second(state); });
}

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

void known_bar_length(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.instrument.emplace_back(
      [a = amplitude_of(settings)](const Occasion& /*occasion*/, InstrumentTruth& truth) {
        truth.length_error += a;
      });
}

struct KnownKind {
  const char* kind;
  void (*act)(const HiddenSettings& settings, HiddenScene& scene);
};

constexpr KnownKind kKnownKinds[] = {
    {"axis-coupling", known_axis_coupling},
    {"ball-bar-length", known_bar_length},
    {"common-expansion", known_common_expansion},
    {"common-growth", known_common_growth},
    {"common-reversal", known_common_reversal},
    {"encoder-subdivision", known_subdivision},
    {"lagged-expansion", known_lagged_expansion},
    {"lagged-temperature", known_lagged_temperature},
    {"lead-error", known_lead_error},
    {"length-scale", known_length_scale},
    {"position-reversal", known_position_reversal},
    {"product-coupling", known_product_coupling},
    {"reversal", known_reversal},
    {"scale-expansion", known_scale_expansion},
    {"screw-heating", known_screw_heating},
    {"spindle-growth", known_spindle_growth},
    {"squareness-drift", known_squareness_drift},
    {"station-drift", known_station_drift},
    {"station-event", known_station_event},
    {"thermal-drift", known_thermal_drift},
    {"tool-clamping", known_tool_clamping},
    {"tool-expansion", known_tool_expansion},
    {"tool-load", known_tool_load},
    {"tool-offset", known_tool_offset},
};

const KnownKind& known_kind_of(const HiddenEffect& effect) {
  for (const KnownKind& known : kKnownKinds) {
    if (effect.kind == known.kind) return known;
  }
  throw InputError(effect.place,
                   "the simulator does not know the effect \"" + effect.kind + "\" of the known errors",
                   "leave it out of a copy of the model, or hide it in the study as a [[hidden]] effect");
}

}  // namespace

void add_known_effects(const ModelSpec& errors, const HiddenContext& context, HiddenScene& scene) {
  for (const EffectSpec& spec : errors.effects) {
    const HiddenEffect effect{spec.kind, spec.options, {}, {}, {errors.file, spec.source_line}};
    known_kind_of(effect).act(HiddenSettings(effect, 0.0, context, "effect of the known errors "), scene);
  }
}

std::vector<std::string> known_effect_kinds() {
  std::vector<std::string> kinds;
  for (const KnownKind& known : kKnownKinds) kinds.emplace_back(known.kind);
  return kinds;
}

}  // namespace volcal::sim
