#include "volcal/sim/machine/control.h"

#include <cmath>
#include <memory>
#include <utility>

namespace volcal::sim {
namespace {

double sign_of(TableValue meaning) { return meaning == TableValue::Error ? -1.0 : 1.0; }

/// Index of the upper end of the interval that q lies in, and how far q is in it, 0 to 1.
std::pair<std::size_t, double> interval_of(const std::vector<double>& position, double q) {
  if (position.size() < 2 || q <= position.front()) return {position.size() < 2 ? 0 : 1, 0.0};
  if (q >= position.back()) return {position.size() - 1, 1.0};
  std::size_t upper = 1;
  while (position[upper] < q) ++upper;
  return {upper, (q - position[upper - 1]) / (position[upper] - position[upper - 1])};
}

double interpolated_between(const std::vector<double>& value, std::size_t upper, double share) {
  if (upper == 0) return value.empty() ? 0.0 : value.front();
  return (1.0 - share) * value[upper - 1] + share * value[upper];
}

double table_value(const ControlAxisTable& table, const MachineState& state) {
  const std::size_t axis = index_of(table.input);
  const auto [upper, share] = interval_of(table.position, state.position[axis]);
  const double plus = interpolated_between(table.towards_plus, upper, share);
  const double minus = interpolated_between(table.towards_minus, upper, share);
  const std::int8_t direction = state.direction[axis];
  return direction > 0 ? plus : direction < 0 ? minus : (plus + minus) / 2.0;
}

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

/// The machine that the tables of single errors describe.
TruthMachine described_machine(const ControlModel& model) {
  TruthMachine machine(model.machine);
  const double to_error = -sign_of(model.meaning);
  for (const auto& [symbol, table] : model.motions)
    machine.add_state_error(symbol, [=, table = table](const MachineState& state) {
      return to_error * table_value(table, state);
    });
  for (const auto& [symbol, value] : model.locations) machine.set_location(symbol, to_error * value);
  return machine;
}

CommandCorrection model_correction(const ControlModel& model) {
  const auto machine = std::make_shared<const TruthMachine>(described_machine(model));
  MachineState home;
  home.direction.fill(1);
  for (const Axis& axis : model.machine.axes) home.position[index_of(axis.name)] = axis.home;
  const Eigen::Vector3d at_home = machine->point_error(home, model.tool);
  return [machine, at_home, tool = model.tool](const MachineState& state) {
    return Eigen::Vector3d(at_home - machine->point_error(state, tool));
  };
}

}  // namespace

CommandCorrection command_correction(const ActiveCompensation& compensation) {
  std::vector<CommandCorrection> models;
  for (const ControlModel& model : compensation.tables.models) models.push_back(model_correction(model));
  const auto tables = std::make_shared<const ControlTables>(compensation.tables);
  return [models, tables, step = compensation.least_increment](const MachineState& state) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const ControlAxisTable& table : tables->axis_tables)
      sum[direction_of(table.output)] += sign_of(table.meaning) * table_value(table, state);
    for (const auto& [table, factor] : tables->products)
      sum[direction_of(table.output)] +=
          sign_of(table.meaning) * table_value(table, state) * table_value(factor, state);
    for (const ControlGrid& grid : tables->grids) sum += grid_correction(grid, state);
    for (const ControlSkew& skew : tables->skews) sum += skew_correction(skew, state);
    for (const CommandCorrection& model : models) sum += model(state);
    if (step > 0.0) {
      for (double& component : sum) component = step * std::floor(component / step + 0.5);
    }
    return sum;
  };
}

}  // namespace volcal::sim
