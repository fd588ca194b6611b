#include "volcal/studies/files/five_axis_machines.h"

#include <numbers>

namespace volcal::studies {

const std::vector<std::string>& five_axis_structures() {
  static const std::vector<std::string> kStructures = {"w C' A' b X Y Z t", "w X' b Y Z C B t",
                                                       "w C' X' b Y Z B t", "w C' B' b X Y Z t"};
  return kStructures;
}

Machine five_axis_machine(const std::string& structure) {
  Machine machine;
  machine.name = structure;
  machine.structure = Structure::parse(structure);
  for (const Joint& joint : machine.structure.joints) {
    Axis axis;
    axis.name = joint.axis;
    axis.travel_min =
        is_rotary(joint.axis) ? (joint.axis == AxisName::C ? -1.0 : -2.0 / 3.0) * std::numbers::pi : -0.8;
    axis.travel_max = -axis.travel_min;
    if (joint.axis == AxisName::A || joint.axis == AxisName::B) axis.centre = {0.0, 0.02, 0.05};
    machine.axes.push_back(axis);
  }
  machine.tools = {
      {"short", {0.0, 0.0, -0.15}, 0.0}, {"long", {0.0, 0.0, -0.3}, 0.0}, {"side", {0.06, 0.0, -0.2}, 0.0}};
  return machine;
}

AxisName tilting_axis(const Machine& machine) {
  return machine.has_axis(AxisName::A) ? AxisName::A : AxisName::B;
}

}  // namespace volcal::studies
