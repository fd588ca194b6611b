#pragma once
/// Machines and errors for tests: by structural code, and at random.

#include <Eigen/Core>
#include <algorithm>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include "volcal/model/description/machine.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal::testing_support {

inline double uniform(std::mt19937_64& random, double half_width) {
  return std::uniform_real_distribution<double>(-half_width, half_width)(random);
}

/// Every component within +-`half_width`.
inline Eigen::Vector3d random_vector(std::mt19937_64& random, double half_width) {
  Eigen::Vector3d v;
  for (double& component : v) component = uniform(random, half_width);
  return v;
}

/// Machine of a structural code; reference points and centres at the origin, travel 0 to 1 m or +-180
/// degrees.
inline Machine machine_of(const std::string& code) {
  Machine machine;
  machine.name = code;
  machine.structure = Structure::parse(code);
  for (const Joint& joint : machine.structure.joints) {
    Axis axis;
    axis.name = joint.axis;
    axis.travel_min = is_rotary(joint.axis) ? -std::numbers::pi : 0.0;
    axis.travel_max = is_rotary(joint.axis) ? std::numbers::pi : 1.0;
    machine.axes.push_back(axis);
  }
  return machine;
}

/// The axes in random order, each on a random side of the bed; reference points within +-0.5 m, centres
/// within +-0.3 m.
inline Machine random_machine(std::mt19937_64& random, std::string letters = "XYZABC") {
  std::ranges::shuffle(letters, random);
  const auto bed = std::uniform_int_distribution<std::size_t>(0, letters.size())(random);
  Machine machine = machine_of("w" + letters.substr(0, bed) + "b" + letters.substr(bed) + "t");
  for (Axis& axis : machine.axes) {
    axis.reference_point = random_vector(random, 0.5);
    axis.centre = random_vector(random, 0.3);
  }
  return machine;
}

/// Within +-1 m and +-180 degrees.
inline AxisPosition random_position(std::mt19937_64& random) {
  AxisPosition position{};
  for (const AxisName axis : kAllAxes) {
    position[index_of(axis)] = uniform(random, is_rotary(axis) ? std::numbers::pi : 1.0);
  }
  return position;
}

/// All motions, rotary locations and the datum's squareness: displacements within +-displacement, rotations
/// within +-rotation.
inline PoseErrors<double> random_errors(std::mt19937_64& random, const Machine& machine, double displacement,
                                        double rotation) {
  PoseErrors<double> errors;
  for (const Axis& axis : machine.axes) {
    for (const Component component : kAllComponents) {
      const double width = is_rotation(component) ? rotation : displacement;
      errors.motion[index_of(axis.name)][index_of(component)] = uniform(random, width);
      if (!is_rotary(axis.name)) continue;
      errors.location[index_of(axis.name)][index_of(component)] = uniform(random, width);
    }
  }
  for (const LocationSymbol symbol : machine.datum.squareness()) {
    errors.location[index_of(symbol.axis)][index_of(symbol.component)] = uniform(random, rotation);
  }
  for (const AxisName axis : machine.parallel_axes()) {
    for (const Component about : {Component::A, Component::B, Component::C}) {
      if (direction_of(about) == direction_of(axis)) continue;
      errors.location[index_of(axis)][index_of(about)] = uniform(random, rotation);
    }
  }
  return errors;
}

inline PoseErrors<double> scaled(PoseErrors<double> errors, double factor) {
  for (auto* table : {&errors.motion, &errors.location}) {
    for (auto& axis : *table) {
      for (double& value : axis) value *= factor;
    }
  }
  return errors;
}

/// One error by its symbol: "EXC", "EX0C", "EC0Y".
inline double& error_of(PoseErrors<double>& errors, const std::string& symbol) {
  if (const auto motion = ErrorSymbol::parse(symbol)) {
    return errors.motion[index_of(motion->axis)][index_of(motion->component)];
  }
  if (const auto location = LocationSymbol::parse(symbol)) {
    return errors.location[index_of(location->axis)][index_of(location->component)];
  }
  throw std::invalid_argument(symbol + " is not an error symbol");
}

}  // namespace volcal::testing_support
