// Effects of instruments, stations and tools.
#include <Eigen/Geometry>
#include <cmath>

#include "volcal/sim/known/known_kinds.h"
#include "volcal/sim/measurement/simulated_instruments.h"

namespace volcal::sim {
namespace {

constexpr double kPush = 1.0;  // s, in which a station that is pushed moves
constexpr double kUsualLobes = 3.0;

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

/// The head out of tram: the tools as they turn with it.
void known_spindle_direction(const HiddenSettings& settings, HiddenScene& scene) {
  const Eigen::Matrix3d turned = (Eigen::AngleAxisd(settings.number("c", 0.0), Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(settings.number("b", 0.0), Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(settings.number("a", 0.0), Eigen::Vector3d::UnitX()))
                                     .toRotationMatrix();
  scene.interference.tool.emplace_back(
      [turned, machine = settings.machine()](const Occasion& occasion) -> Eigen::Vector3d {
        const Eigen::Vector3d& offset = machine.tools[occasion.plan.tool].offset;
        return turned * offset - offset;
      });
}

void known_bar_length(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.instrument.emplace_back(
      [a = amplitude_of(settings)](const Occasion& /*occasion*/, InstrumentTruth& truth) {
        truth.length_error += a;
      });
}

/// By a temperature, or by the time since the setup's first reading.
void known_dead_path(const HiddenSettings& settings, HiddenScene& scene) {
  using Driver = std::function<double(const Occasion& occasion)>;
  Driver driver = [](const Occasion& occasion) { return occasion.state.time - occasion.first_time; };
  if (settings.has("temperature"))
    driver = [excess = settings.excess_temperature("temperature")](const Occasion& occasion) {
      return excess(occasion.state);
    };
  scene.interference.reading.emplace_back(
      [a = amplitude_of(settings), here = settings.where(), driver](const Occasion& occasion,
                                                                    std::size_t channel, double /*value*/) {
        const bool acts = channel == 0 && simulated_instrument(occasion.plan).is_laser && here(occasion);
        return acts ? a * driver(occasion) : 0.0;
      });
}

/// A beam that is not parallel to its path reads too short.
void known_beam_misalignment(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.instrument.emplace_back([a = amplitude_of(settings), here = settings.where()](
                                                 const Occasion& occasion, InstrumentTruth& truth) {
    if (here(occasion)) truth.length_scale -= a;
  });
}

void known_encoder_eccentricity(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.reading.emplace_back([of_cosine = settings.number("cos", 0.0),
                                           of_sine = settings.number("sin", 0.0), here = settings.where(),
                                           encoder = settings.text("encoder", "azimuth")](
                                              const Occasion& occasion, std::size_t channel, double angle) {
    const bool acts = reads_encoder(occasion.plan, channel, encoder) && here(occasion);
    return acts ? of_cosine * std::cos(angle) + of_sine * std::sin(angle) : 0.0;
  });
}

void known_run_offset(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.reading.emplace_back(
      [a = amplitude_of(settings), here = settings.where(),
       run = static_cast<std::int32_t>(std::lround(settings.number("run")))](
          const Occasion& occasion, std::size_t channel, double /*value*/) {
        return channel == 0 && occasion.point.run == run && here(occasion) ? a : 0.0;
      });
}

/// The tip goes on by a wave of the direction of contact about the tool's axis.
void known_probe_lobing(const HiddenSettings& settings, HiddenScene& scene) {
  scene.interference.instrument.emplace_back(
      [of_cosine = settings.number("cos", 0.0), of_sine = settings.number("sin", 0.0),
       lobes = settings.number("lobes", kUsualLobes),
       nominal = TruthMachine(settings.machine())](const Occasion& occasion, InstrumentTruth& truth) {
        const Eigen::Vector3d normal_t =
            nominal.nominal_tool_axes(occasion.state).transpose() * occasion.point.normal_w;
        const double turned = lobes * std::atan2(normal_t.y(), normal_t.x());
        truth.contact_radius += std::hypot(normal_t.x(), normal_t.y()) *
                                (of_cosine * std::cos(turned) + of_sine * std::sin(turned));
      });
}

}  // namespace

std::vector<KnownKind> known_instrument_kinds() {
  return {
      {"ball-bar-length", known_bar_length},  {"beam-misalignment", known_beam_misalignment},
      {"dead-path", known_dead_path},         {"encoder-eccentricity", known_encoder_eccentricity},
      {"length-scale", known_length_scale},   {"probe-lobing", known_probe_lobing},
      {"run-offset", known_run_offset},       {"spindle-direction", known_spindle_direction},
      {"station-drift", known_station_drift}, {"station-event", known_station_event},
      {"tool-clamping", known_tool_clamping}, {"tool-offset", known_tool_offset},
  };
}

}  // namespace volcal::sim
