// What a program of a third party does with the installed library: describe a machine, ask where its tool
// really is when one axis tilts, and see that the exact and the first-order answer agree.

#include <cmath>
#include <iostream>

#include "volcal/model/kinematics/chain.h"

namespace {

volcal::Machine milling_machine() {
  volcal::Machine machine;
  machine.structure = volcal::Structure::parse("w X' b Y Z t");
  for (const volcal::Joint& joint : machine.structure.joints) {
    machine.axes.push_back({.name = joint.axis, .travel_min = 0.0, .travel_max = 1.0});
  }
  return machine;
}

}  // namespace

int main() {
  const volcal::Machine machine = milling_machine();
  const volcal::KinematicChain chain(machine);

  // Abbe: EBX = 10 urad at 0.5 m below the reference point moves the tool by -5 um in x.
  volcal::PoseErrors<double> errors;
  errors.motion[index_of(volcal::AxisName::X)][index_of(volcal::Component::B)] = 10e-6;
  const volcal::AxisPosition position = {0.2, 0.3, 0.0};
  const Eigen::Vector3d tool_offset(0.0, 0.0, -0.5);

  const Eigen::Vector3d nominal = chain.nominal_point_w(position, tool_offset);
  const Eigen::Vector3d first_order = chain.first_order(position, tool_offset, errors).displacement_w;
  const Eigen::Vector3d exact = chain.exact_pose<double>(position, tool_offset, errors).point_w - nominal;

  std::cout << machine.structure.code << ": EBX of 10 urad, tool 500 mm long: ex = " << exact.x() * 1e6
            << " um\n";
  const bool right = std::abs(first_order.x() + 5e-6) < 1e-12 && (exact - first_order).norm() < 1e-9;
  std::cout << (right ? "consumer: volcal works\n" : "consumer: wrong displacement\n");
  return right ? 0 : 1;
}
