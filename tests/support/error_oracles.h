#pragma once
/// Errors of a machine by the plain way, for tests of the fast ones.

#include <span>
#include <vector>

#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/error_tables.h"
#include "volcal/model/description/parameter_names.h"

namespace volcal::testing {

/// All planes of for_each_plane_of_grid().
inline std::vector<VolumetricError> volumetric_grid(const FitResult& result, int per_axis,
                                                    const Conditions& conditions) {
  std::vector<VolumetricError> grid;
  for_each_plane_of_grid(result, per_axis, conditions, [&grid](std::span<const VolumetricError> nodes) {
    grid.insert(grid.end(), nodes.begin(), nodes.end());
  });
  return grid;
}

/// displacement_field() along the chain, joint by joint, at every call.
inline DisplacementField plain_displacement_field(const FitResult& result, const Tool& tool,
                                                  const Conditions& conditions) {
  FitResult linear = result;
  for (const FunctionGroup& group : linear.layout.groups) {
    if (is_rotary(group.axis)) linear.parameters.segment(group.offset, group.size()).setZero();
  }
  for (const ParameterBlock& block : linear.layout.blocks) {
    if (block.location && is_rotary(block.location->axis)) linear.parameters[block.offset] = 0.0;
    if (block.name == tool_parameter(tool.name))
      linear.parameters.segment(block.offset, block.size()).setZero();
  }
  const MachineEffects effects(result, tool, conditions);
  for (const EffectColumn& column : effects.columns()) {
    if (column.target.kind == TargetKind::Motion && is_rotary(column.target.symbol.axis))
      linear.parameters[column.amplitude_parameter] = 0.0;
  }
  return [field = ErrorField(linear, tool, conditions)](
             const AxisPosition& position, const ApproachDirection& direction) -> Eigen::Vector3d {
    return field.at(without_rotary_axes(position), direction).head<3>();
  };
}

}  // namespace volcal::testing
