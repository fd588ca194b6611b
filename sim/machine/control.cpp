#include "volcal/sim/machine/control.h"

#include <cmath>
#include <memory>
#include <utility>

#include "volcal/sim/machine/control_kinematics.h"

namespace volcal::sim {
namespace {

/// Trilinear value of vectors at the nodes.
Eigen::Vector3d grid_value(const std::array<std::vector<double>, 3>& nodes,
                           const std::vector<Eigen::Vector3d>& value, const MachineState& state) {
  const std::size_t ny = nodes[1].size(), nz = nodes[2].size();
  const auto [i, s] = interval_of(nodes[0], state.position[0]);
  const auto [j, t] = interval_of(nodes[1], state.position[1]);
  const auto [k, u] = interval_of(nodes[2], state.position[2]);
  const auto at = [&](std::size_t a, std::size_t b, std::size_t c) { return value[(a * ny + b) * nz + c]; };
  const auto below = [](std::size_t upper) { return upper == 0 ? 0 : upper - 1; };
  const auto along_z = [&, k = k, u = u](std::size_t a, std::size_t b) -> Eigen::Vector3d {
    return (1.0 - u) * at(a, b, below(k)) + u * at(a, b, k);
  };
  const auto along_y = [&, j = j, t = t](std::size_t a) -> Eigen::Vector3d {
    return (1.0 - t) * along_z(a, below(j)) + t * along_z(a, j);
  };
  return (1.0 - s) * along_y(below(i)) + s * along_y(i);
}

Eigen::Vector3d grid_correction(const ControlGrid& grid, const MachineState& state) {
  Eigen::Vector3d sum = grid_value(grid.nodes, grid.mean, state);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!grid.reversal[axis].empty())
      sum += 0.5 * state.direction[axis] * grid_value(grid.nodes, grid.reversal[axis], state);
  }
  return sign_of(grid.meaning) * sum;
}

Eigen::Vector3d skew_correction(const ControlSkew& skew, const MachineState& state) {
  const double y = state.position[1], z = state.position[2];
  return {-(y * skew.xy) - z * (skew.xz - skew.xy * skew.yz), -(z * skew.yz), 0.0};
}

double& moved_by(CommandMoves& moves, AxisName output) {
  return (is_rotary(output) ? moves.rotary : moves.linear)[direction_of(output)];
}

}  // namespace

CommandCorrection command_correction(const ActiveCompensation& compensation) {
  std::vector<CommandCorrection> computed;
  for (const ControlModel& model : compensation.tables.models) computed.push_back(model_correction(model));
  for (const ControlTwistGrid& grid : compensation.tables.twist_grids)
    computed.push_back(twist_correction(grid));
  for (const ControlPivotChange& change : compensation.tables.pivots)
    computed.push_back(pivot_correction(change));
  const auto tables = std::make_shared<const ControlTables>(compensation.tables);
  return [computed, tables, step = compensation.least_increment](const MachineState& state) {
    CommandMoves sum;
    for (const ControlAxisTable& table : tables->axis_tables)
      moved_by(sum, table.output) += sign_of(table.meaning) * table_value(table, state);
    for (const auto& [table, factor] : tables->products)
      moved_by(sum, table.output) +=
          sign_of(table.meaning) * table_value(table, state) * table_value(factor, state);
    for (const ControlGrid& grid : tables->grids) sum.linear += grid_correction(grid, state);
    for (const ControlSkew& skew : tables->skews) sum.linear += skew_correction(skew, state);
    for (const CommandCorrection& of_computed : computed) sum += of_computed(state);
    if (step > 0.0) {
      for (double& component : sum.linear) component = step * std::floor(component / step + 0.5);
    }
    return sum;
  };
}

}  // namespace volcal::sim
