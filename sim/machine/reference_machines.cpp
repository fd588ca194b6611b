#include "volcal/sim/machine/reference_machines.h"

#include <numbers>

namespace volcal::sim {

Machine machine_from_code(const std::string& code,
                          const std::array<std::array<double, 2>, 3>& linear_travel) {
  Machine machine;
  machine.name = code;
  machine.structure = Structure::parse(code);
  for (const Joint& joint : machine.structure.joints) {
    Axis axis;
    axis.name = joint.axis;
    if (is_rotary(joint.axis)) {
      axis.travel_min = -std::numbers::pi;
      axis.travel_max = std::numbers::pi;
    } else {
      const auto& travel = linear_travel[static_cast<std::size_t>(direction_of(joint.axis))];
      axis.travel_min = axis.home = travel[0];
      axis.travel_max = travel[1];
    }
    machine.axes.push_back(axis);
  }
  machine.tools = {{"short", {0.0, 0.0, -0.15}, 0.0},
                   {"side_x", {0.11, 0.015, -0.24}, 0.0},
                   {"side_y", {-0.02, 0.13, -0.28}, 0.0}};
  return machine;
}

std::vector<Machine> reference_machines() {
  return {machine_from_code("w X b Y Z t", {{{0.0, 1.0}, {0.0, 0.6}, {0.0, 0.5}}}),
          machine_from_code("w X' Y' b Z t", {{{-0.4, 0.4}, {-0.25, 0.25}, {-0.45, 0.0}}}),
          machine_from_code("w b X Y Z t", {{{0.0, 2.5}, {0.0, 1.2}, {0.0, 0.8}}}),
          machine_from_code("w Y' b X Z t", {{{0.0, 0.5}, {0.0, 0.4}, {0.0, 0.33}}})};
}

}  // namespace volcal::sim
