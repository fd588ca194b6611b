#pragma once
/// Machines with identified errors of rotary axes: a trunnion, a head, one axis on either side.

#include <cmath>
#include <numbers>
#include <string>

#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "volcal/model/description/units.h"

namespace volcal::testing {

inline constexpr const char* kTrunnion = "w C' A' b X Y Z t";
inline constexpr const char* kHead = "w X' b Y Z C B t";
inline constexpr const char* kMixed = "w C' X' b Y Z B t";

/// Linear axes travel +-300 mm, C a turn, A and B +-110 degrees; centres off the origin; tools of 200 and
/// 300 mm.
inline Machine rotary_machine(const std::string& structure) {
  Machine machine = testing_support::machine_of(structure);
  for (Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) {
      axis.travel_min = -0.3;
      axis.travel_max = 0.3;
    } else if (axis.name != AxisName::C) {
      axis.travel_min = -110.0 * kRadianPerDegree;
      axis.travel_max = 110.0 * kRadianPerDegree;
    }
    if (axis.name == AxisName::A) axis.centre = {0.0, 0.01, 0.05};
    if (axis.name == AxisName::B) axis.centre = {0.02, 0.0, -0.03};
    if (axis.name == AxisName::C) axis.centre = {0.01, -0.02, 0.0};
  }
  machine.tools = {{"short", {0.0, 0.0, -0.2}, 0.0}, {"long", {0.0, 0.0, -0.3}, 0.0}};
  return machine;
}

/// All errors of the rotary axes: locations, and error motions that repeat after a turn, polylines of 10
/// degrees on C; positioning zero at 0. 1 um or 1 urad of standard uncertainty of every parameter.
inline FitResult rotary_result(const std::string& structure) {
  const Machine machine = rotary_machine(structure);
  GivenErrors given;
  double phase = 0.3;
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) continue;
    for (const Component component : kAllComponents) {
      phase += 0.7;
      const ErrorSymbol symbol{component, axis.name};
      const double size = is_rotation(component) ? 15e-6 : 3e-6;
      const double at_zero = symbol.is_positioning() ? size * std::sin(phase) : 0.0;
      given.functions[symbol.name()] = [=](double q) { return size * std::sin(q + phase) - at_zero; };
      const bool along = !is_rotation(component) && direction_of(component) == direction_of(axis.name);
      if (!along)
        given.locations[LocationSymbol{component, axis.name}.name()] =
            (is_rotation(component) ? 40e-6 : 15e-6) * std::cos(2.0 * phase);
    }
  }
  FitResult result = result_with(machine, given, 36);
  result.covariance = 1e-12 * Eigen::MatrixXd::Identity(result.layout.size, result.layout.size);
  return result;
}

}  // namespace volcal::testing
