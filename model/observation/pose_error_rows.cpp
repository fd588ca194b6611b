#include <stdexcept>

#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

const JointLever& lever_of(const JointLever* levers, std::size_t count, AxisName axis) {
  for (std::size_t i = 0; i < count; ++i) {
    if (levers[i].axis == axis) return levers[i];
  }
  throw std::logic_error("axis is not a joint of the chain");
}

}  // namespace

PoseErrors<double> pose_errors(const ParameterLayout& layout, const AxisPosition& position,
                               const Eigen::VectorXd& parameters) {
  PoseErrors<double> errors;
  double values[kMaxBasisSupport];
  for (const FunctionGroup& group : layout.groups) {
    const int start = group.basis->evaluate(position[index_of(group.axis)], values);
    for (int slot = 0; slot < group.count(); ++slot) {
      double sum = 0.0;
      for (int j = 0; j < group.basis->support(); ++j)
        sum += values[j] * parameters[group.index(start + j, slot)];
      const ErrorSymbol symbol = group.symbols[static_cast<std::size_t>(slot)];
      errors.motion[index_of(symbol.axis)][index_of(symbol.component)] = sum;
    }
  }
  for (const ParameterBlock& block : layout.blocks) {
    if (!block.location) continue;
    errors.location[index_of(block.location->axis)][index_of(block.location->component)] =
        parameters[block.offset];
  }
  return errors;
}

Eigen::Matrix<double, 6, Eigen::Dynamic> pose_error_rows(const KinematicChain& chain,
                                                         const ParameterLayout& layout,
                                                         const AxisPosition& position,
                                                         const Eigen::Vector3d& tool_offset,
                                                         const AxisPosition& measured) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> rows =
      Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, layout.size);
  JointLever levers[kAxisCount];
  chain.levers(position, tool_offset, levers);
  double values[kMaxBasisSupport];
  for (const FunctionGroup& group : layout.groups) {
    const JointLever& lever = lever_of(levers, chain.joint_count(), group.axis);
    const int start = group.basis->evaluate(measured[index_of(group.axis)], values);
    for (int slot = 0; slot < group.count(); ++slot) {
      const Component component = group.symbols[static_cast<std::size_t>(slot)].component;
      Eigen::Matrix<double, 6, 1> column;
      column.head<3>() = KinematicChain::motion_lever_w(lever, component);
      column.tail<3>().setZero();
      if (is_rotation(component)) column.tail<3>() = lever.rotation_ws.col(direction_of(component));
      for (int j = 0; j < group.basis->support(); ++j)
        rows.col(group.index(start + j, slot)) = values[j] * column;
    }
  }
  for (const ParameterBlock& block : layout.blocks) {
    if (!block.location) continue;
    const JointLever& lever = lever_of(levers, chain.joint_count(), block.location->axis);
    rows.col(block.offset).head<3>() = KinematicChain::location_lever_w(lever, block.location->component);
    rows.col(block.offset).tail<3>() = KinematicChain::location_rotation_w(lever, block.location->component);
  }
  return rows;
}

}  // namespace volcal
