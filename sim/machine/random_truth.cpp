#include "volcal/sim/machine/random_truth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "volcal/sim/machine/datum.h"
#include "volcal/sim/machine/random.h"
#include "volcal/sim/machine/transforms.h"

namespace volcal::sim {
namespace {

constexpr int kHighestDegree = 7;
constexpr int kHighestHarmonic = 9;
constexpr double kStraightness = 5e-6;     ///< m, before scaling to the volumetric error
constexpr double kPositioning = 6e-6;      ///< m
constexpr double kAngle = 8e-6;            ///< rad
constexpr double kSquarenessMin = 5e-6;    ///< rad
constexpr double kSquarenessMax = 30e-6;   ///< rad
constexpr double kRotaryMotion = 3e-6;     ///< m
constexpr double kRotaryTilt = 15e-6;      ///< rad
constexpr double kRotaryOffset = 15e-6;    ///< m
constexpr double kRotaryLocation = 40e-6;  ///< rad
constexpr double kWave = 0.12;             ///< of a sine, as a share of the function's size

struct Wave {
  double amplitude;
  double wave_number;  ///< rad per unit of position
  double phase;
};

/// Series on t in [-1, 1] over the travel, sines on the position, and a line through home.
struct SmoothFunction {
  double low = 0.0;
  double high = 1.0;
  double home = 0.0;
  std::array<double, kHighestDegree + 1> legendre{};
  std::vector<Wave> waves;
  double slope = 0.0;
  double at_home = 0.0;

  double raw(double q) const {
    const double t = (2.0 * q - low - high) / (high - low);
    double previous = 1.0;
    double current = t;
    double sum = legendre[1] * t;
    for (int n = 2; n <= kHighestDegree; ++n) {
      const double next = ((2 * n - 1) * t * current - (n - 1) * previous) / n;
      previous = current;
      current = next;
      sum += legendre[static_cast<std::size_t>(n)] * current;
    }
    for (const Wave& wave : waves) sum += wave.amplitude * std::sin(wave.wave_number * q + wave.phase);
    return sum;
  }
  double operator()(double q) const { return raw(q) - at_home - slope * (q - home); }
};

SmoothFunction linear_axis_function(const Axis& axis, ErrorSymbol symbol, double size, double wave_scale,
                                    RandomStream& random) {
  SmoothFunction f;
  f.low = axis.travel_min;
  f.high = axis.travel_max;
  f.home = axis.home;
  for (int n = symbol.is_straightness() ? 2 : 1; n <= kHighestDegree; ++n) {
    f.legendre[static_cast<std::size_t>(n)] = size * random.normal() / std::pow(n, 1.5);
  }
  const std::array<double, 2> share_of_travel = {random.uniform(0.48, 0.85), random.uniform(0.32, 0.48)};
  f.waves.resize(2);
  for (std::size_t i = 0; i < 2; ++i) {
    f.waves[i] = {size * kWave * wave_scale * random.uniform(0.5, 1.0) / static_cast<double>(i + 1),
                  2.0 * std::numbers::pi / (share_of_travel[i] * axis.travel()),
                  random.uniform(0.0, 2.0 * std::numbers::pi)};
  }
  f.at_home = f.raw(axis.home);
  return f;
}

/// Slopes that stand for a rotation of the machine frame: both of the primary axis, and of the secondary axis
/// the one along the third direction.
bool turns_frame(const Datum& datum, ErrorSymbol symbol) {
  if (!symbol.is_straightness()) return false;
  if (symbol.axis == datum.primary) return true;
  return symbol.axis == datum.secondary && direction_of(symbol.component) == direction_of(datum.third());
}

/// An axis that turns right round has harmonics of the turn, its errors at both ends being those of one
/// place; another has waves of any length.
SmoothFunction rotary_function(const Axis& axis, double size, double wave_scale, RandomStream& random) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  constexpr double kClosed = 1e-6;  // rad
  SmoothFunction f;
  f.low = axis.travel_min;
  f.high = axis.travel_max;
  f.home = axis.home;
  if (axis.travel() > kTurn - kClosed) {
    f.waves.push_back({size * random.uniform(0.5, 1.0), 1.0, random.uniform(0.0, kTurn)});
    for (int n = 2; n <= kHighestHarmonic; ++n) {
      const double share = 0.5 * wave_scale * random.uniform(0.5, 1.0) / std::pow(n, 1.5);
      f.waves.push_back({size * share, static_cast<double>(n), random.uniform(0.0, kTurn)});
    }
  } else {
    f.waves.push_back(
        {size * random.uniform(0.5, 1.0), random.uniform(1.6, 2.4), random.uniform(0.0, kTurn)});
    f.waves.push_back({size * 0.3 * wave_scale * random.uniform(0.5, 1.0), random.uniform(3.5, 4.5),
                       random.uniform(0.0, kTurn)});
  }
  f.at_home = f.raw(axis.home);
  return f;
}

/// Sizes of one truth before it is scaled to its volumetric error.
struct Draft {
  std::vector<std::pair<ErrorSymbol, SmoothFunction>> functions;
  std::vector<std::pair<LocationSymbol, double>> locations;
};

void draft_linear_axis(const Machine& machine, const Axis& axis, std::uint64_t seed,
                       const RandomTruthOptions& options, Draft& draft) {
  for (const Component component : kAllComponents) {
    const ErrorSymbol symbol{component, axis.name};
    RandomStream random(seed, "truth function " + symbol.name());
    const double length_factor = std::sqrt(axis.travel() / 0.5);
    const double size = is_rotation(component)    ? kAngle * options.angular_scale
                        : symbol.is_positioning() ? kPositioning * length_factor
                                                  : kStraightness * length_factor;
    SmoothFunction f = linear_axis_function(axis, symbol, size, options.wave_scale, random);
    if (turns_frame(machine.datum, symbol)) {
      f.slope = least_squares_slope([&](double q) { return f.raw(q); }, axis.travel_min, axis.travel_max);
    }
    draft.functions.emplace_back(symbol, f);
  }
}

void draft_rotary_axis(const Axis& axis, std::uint64_t seed, const RandomTruthOptions& options,
                       Draft& draft) {
  for (const Component component : kAllComponents) {
    const ErrorSymbol symbol{component, axis.name};
    RandomStream random(seed, "truth function " + symbol.name());
    const double size = is_rotation(component) ? kRotaryTilt * options.angular_scale : kRotaryMotion;
    draft.functions.emplace_back(symbol, rotary_function(axis, size, options.wave_scale, random));
    const double spread = is_rotation(component) ? kRotaryLocation : kRotaryOffset;
    draft.locations.emplace_back(LocationSymbol{component, axis.name}, spread * random.normal());
  }
}

/// Angles of U, V, W, each with numbers of its own: other axes keep theirs.
void draft_parallel_axes(const Machine& machine, std::uint64_t seed, const RandomTruthOptions& options,
                         Draft& draft) {
  for (const AxisName axis : machine.parallel_axes()) {
    for (const LocationSymbol& symbol : linear_locations(machine, axis)) {
      RandomStream random(seed, "truth angle " + symbol.name());
      const double size = random.uniform(kSquarenessMin, kSquarenessMax) * options.squareness_scale;
      draft.locations.emplace_back(symbol, random.sign() * size);
    }
  }
}

TruthMachine assemble(const Machine& machine, const Draft& draft, double scale) {
  TruthMachine truth(machine);
  for (const auto& [symbol, function] : draft.functions) {
    const double factor = is_rotary(symbol.axis) ? 1.0 : scale;
    truth.set_error(symbol, [function = function, factor](double q) { return factor * function(q); });
  }
  for (const auto& [symbol, value] : draft.locations) {
    truth.set_location(symbol, is_rotary(symbol.axis) ? value : scale * value);
  }
  return truth;
}

/// Two axes or more give a frame and an area in which errors are judged.
bool has_frame(const Machine& machine) {
  return machine.has_axis(machine.datum.primary) && machine.has_axis(machine.datum.secondary);
}

}  // namespace

double volumetric_rms(const TruthMachine& truth, const Eigen::Vector3d& tool_offset) {
  constexpr int kGrid = 8;
  std::vector<MachineState> states(1);
  for (const Axis& axis : truth.machine().axes) states[0].position[index_of(axis.name)] = axis.home;
  for (const Axis& axis : truth.machine().axes) {
    if (is_rotary(axis.name)) continue;
    std::vector<MachineState> finer;
    for (const MachineState& state : states) {
      for (int i = 0; i < kGrid; ++i) {
        finer.push_back(state);
        finer.back().position[index_of(axis.name)] = axis.travel_min + axis.travel() * (i + 0.5) / kGrid;
      }
    }
    states = std::move(finer);
  }
  std::vector<Eigen::Vector3d> point;
  std::vector<Eigen::Vector3d> error;
  for (const MachineState& state : states) {
    point.push_back(truth.nominal_point(state, tool_offset));
    error.emplace_back(truth.point(state, tool_offset) - point.back());
  }
  return rms_after_alignment(point, error);
}

TruthMachine random_truth(const Machine& machine, std::uint64_t seed, const RandomTruthOptions& options) {
  Draft draft;
  for (const Axis& axis : machine.axes) {
    if (is_rotary(axis.name)) {
      draft_rotary_axis(axis, seed, options, draft);
    } else {
      draft_linear_axis(machine, axis, seed, options, draft);
    }
  }
  RandomStream random(seed, "truth sizes");
  double scale = 1.0;
  if (has_frame(machine)) {
    for (const LocationSymbol& symbol : machine.datum.squareness()) {
      if (!machine.has_axis(symbol.axis)) continue;
      const double size = random.uniform(kSquarenessMin, kSquarenessMax) * options.squareness_scale;
      draft.locations.emplace_back(symbol, random.sign() * size);
    }
    draft_parallel_axes(machine, seed, options, draft);
    Draft linear = draft;
    std::erase_if(linear.functions, [](const auto& entry) { return is_rotary(entry.first.axis); });
    std::erase_if(linear.locations, [](const auto& entry) { return is_rotary(entry.first.axis); });
    const Eigen::Vector3d tool =
        machine.tools.empty() ? Eigen::Vector3d::Zero() : machine.tools.front().offset;
    scale = random.uniform(options.volumetric_rms_min, options.volumetric_rms_max) /
            volumetric_rms(assemble(machine, linear, 1.0), tool);
  }
  TruthMachine truth = assemble(machine, draft, scale);
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      if (!is_rotation(component) && !symbol.is_positioning()) continue;
      const double largest = is_rotation(component) ? options.angular_reversal_max : options.reversal_max;
      if (largest > 0.0) truth.set_reversal(symbol, random.uniform(0.0, largest));
    }
  }
  return truth;
}

}  // namespace volcal::sim
