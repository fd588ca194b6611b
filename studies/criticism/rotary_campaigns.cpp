#include "volcal/studies/criticism/rotary_campaigns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "volcal/studies/files/five_axis_machines.h"

namespace volcal::studies {
namespace {

constexpr double kLinearShare = 1.0 / 3.0;  // of the readings
constexpr double kGridShare = 4.0 / 3.0;    // positions of C for one of the axis that tilts
constexpr int kLeastPositions = 5;          // of a rotary axis: two harmonics
constexpr double kJitter = 0.3;

template <class Values>
auto any_of(sim::RandomStream& random, const Values& values) {
  return values[static_cast<std::size_t>(random.uniform() * static_cast<double>(std::size(values)))];
}

int positions(double count, int least) { return std::max(least, static_cast<int>(std::lround(count))); }

/// "EY0C": a displacement across the axis or a tilt.
std::string location_of(AxisName axis, sim::RandomStream& random) {
  std::vector<std::string> names;
  for (const Component component : kAllComponents) {
    if (direction_of(component) != direction_of(axis))
      names.push_back(LocationSymbol{component, axis}.name());
  }
  return any_of(random, names);
}

}  // namespace

std::span<const std::string> rotary_kinds() {
  static const std::vector<std::string> kKinds = {"worm", "cradle-table", "squareness-channel", "reversal"};
  return kKinds;
}

Machine rotary_machine(int index) {
  const auto& structures = five_axis_structures();
  const auto number = static_cast<std::size_t>(index);
  // Kinds take turns too: after a round of them the structures move on by one.
  return five_axis_machine(structures[(number + number / rotary_kinds().size()) % structures.size()]);
}

void measure_rotary_axes(sim::Study& study, int readings, const sim::NoiseLevel& noise) {
  sim::Tracking tracking;
  tracking.noise = noise;
  const double runs = 2.0 * 8.0;  // there and back, four stations with two tools
  const double scale = std::cbrt(readings * kLinearShare / runs / (5.0 * 4.0 * 4.0));
  tracking.grid = {positions(5.0 * scale, 3), positions(4.0 * scale, 3), positions(4.0 * scale, 3)};
  study.measurements.emplace_back().settings = tracking;

  sim::RTest spheres;
  spheres.noise = noise;
  spheres.poses.spheres = {
      {"S1", {0.12, 0.0, 0.05}}, {"S2", {-0.06, 0.1, 0.05}}, {"S3", {-0.06, -0.1, 0.12}}};
  // Three components, three spheres with three tools.
  const double poses = readings * (1.0 - kLinearShare) / 27.0;
  const double tilts = std::sqrt(poses / kGridShare);
  spheres.poses.grid.points = {{tilting_axis(study.machine), positions(tilts, kLeastPositions)},
                               {AxisName::C, positions(tilts * kGridShare, kLeastPositions)}};
  spheres.poses.grid.jitter = kJitter;
  study.measurements.emplace_back().settings = spheres;
}

sim::HiddenEffect random_rotary_effect(const std::string& kind, const sim::Study& study,
                                       sim::RandomStream& random) {
  const std::vector<AxisName> axes = study.machine.rotary_axes();
  sim::HiddenEffect effect;
  effect.kind = kind;
  const auto set = [&](const std::string& stem, OptionValue value) {
    effect.options.set(stem, std::move(value));
  };
  const double turn = 2.0 * std::numbers::pi;
  if (kind == "worm") {
    const AxisName axis = any_of(random, axes);
    set("symbol", ErrorSymbol{positioning_component(axis), axis}.name());
    set("period", turn / any_of(random, std::array{36.0, 60.0, 72.0, 90.0, 120.0}));
    set("phase", random.uniform(0.0, turn));
  } else if (kind == "cradle-table") {
    set("symbol", ErrorSymbol{any_of(random, kAllComponents), AxisName::C}.name());
    set("by", std::string(1, letter_of(tilting_axis(study.machine))));
    set("phase", random.uniform(0.0, turn));
  } else if (kind == "squareness-channel") {
    const AxisName axis = any_of(random, axes);
    set("symbol", location_of(axis, random));
    set("channel", any_of(random, study.environment.channels).name);
  } else {
    const AxisName axis = any_of(random, axes);
    set("symbol", ErrorSymbol{any_of(random, kAllComponents), axis}.name());
  }
  return effect;
}

ModelSpec without_rotary_errors(const Machine& machine) {
  ModelSpec model;
  for (const AxisName axis : machine.rotary_axes()) {
    for (const Component component : kAllComponents) {
      model.functions[{component, axis}].basis = "zero";
      if (direction_of(component) != direction_of(axis) || is_rotation(component))
        model.locations_off.push_back({component, axis});
    }
  }
  return model;
}

}  // namespace volcal::studies
