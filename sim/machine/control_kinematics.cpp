#include "volcal/sim/machine/control_kinematics.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "volcal/sim/machine/transforms.h"

namespace volcal::sim {

double sign_of(TableValue meaning) { return meaning == TableValue::Error ? -1.0 : 1.0; }

std::pair<std::size_t, double> interval_of(const std::vector<double>& position, double q) {
  if (position.size() < 2 || q <= position.front()) return {position.size() < 2 ? 0 : 1, 0.0};
  if (q >= position.back()) return {position.size() - 1, 1.0};
  std::size_t upper = 1;
  while (position[upper] < q) ++upper;
  return {upper, (q - position[upper - 1]) / (position[upper] - position[upper - 1])};
}

namespace {

double interpolated_between(const std::vector<double>& value, std::size_t upper, double share) {
  if (upper == 0) return value.empty() ? 0.0 : value.front();
  return (1.0 - share) * value[upper - 1] + share * value[upper];
}

/// q between `first` and a period behind it.
double within_period(double q, double first, double period) {
  const double turns = (q - first) / period;
  return q - period * std::floor(turns + 1e-12);
}

}  // namespace

double table_value(const ControlAxisTable& table, const MachineState& state) {
  const std::size_t axis = index_of(table.input);
  double q = state.position[axis];
  if (table.period > 0.0 && !table.position.empty())
    q = within_period(q, table.position.front(), table.period);
  const auto [upper, share] = interval_of(table.position, q);
  const double plus = interpolated_between(table.towards_plus, upper, share);
  const double minus = interpolated_between(table.towards_minus, upper, share);
  const std::int8_t direction = state.direction[axis];
  return direction > 0 ? plus : direction < 0 ? minus : (plus + minus) / 2.0;
}

namespace {

constexpr double kHardlyMoves = 0.05;         // of the length of the way of a linear axis
constexpr double kAtTheNominalPoint = 1e-13;  // m
constexpr int kMostControlSteps = 8;

/// Ways of the functional point when X, Y, Z go 1 m, workpiece coordinates; nothing for an axis that the
/// machine lacks.
Eigen::Matrix3d ways_of_linear_axes(const TruthMachine& nominal, const MachineState& state,
                                    const Eigen::Vector3d& tool) {
  Eigen::Matrix3d ways = Eigen::Matrix3d::Zero();
  const Eigen::Vector3d here = nominal.nominal_point(state, tool);
  for (const AxisName axis : kLinearAxes) {
    if (!nominal.machine().has_axis(axis)) continue;
    MachineState moved = state;
    moved.position[index_of(axis)] += 1.0;
    ways.col(direction_of(axis)) = nominal.nominal_point(moved, tool) - here;
  }
  return ways;
}

/// Least squares; what the axes together hardly move is left, by the eigenvectors of the normal matrix.
Eigen::Vector3d moves_along(const Eigen::Matrix3d& ways, const Eigen::Vector3d& displacement) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> normal(ways.transpose() * ways);
  const Eigen::Vector3d right = ways.transpose() * displacement;
  Eigen::Vector3d moves = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double square = normal.eigenvalues()[k];
    const Eigen::Vector3d along = normal.eigenvectors().col(k);
    if (square > kHardlyMoves * kHardlyMoves) moves += along.dot(right) / square * along;
  }
  return moves;
}

/// The machine that tables of single errors describe, of linear or of rotary axes.
TruthMachine described_machine(const ControlModel& model, bool rotary) {
  TruthMachine machine(model.machine);
  const double to_error = -sign_of(model.meaning);
  for (const auto& [symbol, table] : model.motions) {
    if (is_rotary(symbol.axis) != rotary) continue;
    machine.add_state_error(symbol, [=, table = table](const MachineState& state) {
      return to_error * table_value(table, state);
    });
  }
  for (const auto& [symbol, value] : model.locations) {
    if (is_rotary(symbol.axis) == rotary) machine.set_location(symbol, to_error * value);
  }
  return machine;
}

/// Whether it turns the workpiece by the axis nearest to the bed, and has errors of that.
bool turns_the_workpiece(const ControlModel& model) {
  if (model.rotary == RotaryModel::None) return false;
  const auto& joints = model.machine.structure.joints;
  const auto outermost = std::find_if(joints.rbegin(), joints.rend(), [](const Joint& joint) {
    return joint.workpiece_side && is_rotary(joint.axis);
  });
  if (outermost == joints.rend()) return false;
  const auto is_its = [&](const auto& entry) { return entry.first.axis == outermost->axis; };
  return std::ranges::any_of(model.motions, is_its) || std::ranges::any_of(model.locations, is_its);
}

CommandCorrection linear_model_correction(const ControlModel& model) {
  const auto machine = std::make_shared<const TruthMachine>(described_machine(model, false));
  MachineState home;
  home.direction.fill(1);
  for (const Axis& axis : model.machine.axes) {
    if (!is_rotary(axis.name)) home.position[index_of(axis.name)] = axis.home;
  }
  Eigen::Vector3d at_home = Eigen::Vector3d::Zero();
  if (!turns_the_workpiece(model)) at_home = machine->point_error(home, model.tool);
  return [machine, at_home, tool = model.tool](MachineState state) {
    for (const AxisName axis : kAllAxes) {
      if (is_rotary(axis)) state.position[index_of(axis)] = 0.0;
    }
    return CommandMoves(at_home - machine->point_error(state, tool));
  };
}

/// Rotations of A, B, C about themselves.
Eigen::Vector3d own_rotations(const TruthMachine& machine, const MachineState& state) {
  Eigen::Vector3d own = Eigen::Vector3d::Zero();
  for (const Axis& axis : machine.machine().axes) {
    if (!is_rotary(axis.name)) continue;
    const auto k = static_cast<std::size_t>(direction_of(axis.name));
    const Component about = kAllComponents[3 + k];
    own[direction_of(axis.name)] =
        machine.error({about, axis.name}, state) + machine.location({about, axis.name});
  }
  return own;
}

/// Turns first, then linear moves until the functional point of the described machine is the nominal one.
CommandCorrection rotary_model_correction(const ControlModel& model) {
  const auto machine = std::make_shared<const TruthMachine>(described_machine(model, true));
  const bool turns = model.rotary == RotaryModel::TurnsTheAxes;
  return [machine, turns, tool = model.tool](const MachineState& state) {
    CommandMoves moves;
    if (turns) moves.rotary = -own_rotations(*machine, state);
    const Eigen::Vector3d wanted = machine->nominal_point(state, tool);
    const Eigen::Matrix3d ways = ways_of_linear_axes(*machine, state, tool);
    for (int step = 0; step < kMostControlSteps; ++step) {
      MachineState commanded = state;
      for (std::size_t k = 0; k < 3; ++k) {
        commanded.position[k] += moves.linear[static_cast<Eigen::Index>(k)];
        commanded.position[k + 3] += moves.rotary[static_cast<Eigen::Index>(k)];
      }
      const Eigen::Vector3d missing = wanted - machine->point(commanded, tool);
      const Eigen::Vector3d move = moves_along(ways, missing);
      moves.linear += move;
      if (move.norm() < kAtTheNominalPoint) break;
    }
    return moves;
  };
}

/// Product of nominal joints from index `first` to before `last`.
Eigen::Matrix4d nominal_joints(const Machine& machine, const MachineState& state, std::size_t first,
                               std::size_t last) {
  Eigen::Matrix4d product = Eigen::Matrix4d::Identity();
  for (std::size_t i = first; i < last; ++i) {
    const AxisName name = machine.structure.joints[i].axis;
    const double q = state.position[index_of(name)];
    if (is_rotary(name)) {
      const Eigen::Vector3d& c = machine.axis(name).centre;
      product *= translation(c) * rotation_about(direction_of(name), q) * translation(-c);
    } else {
      product *= translation(q * unit(name));
    }
  }
  return product;
}

/// Joints that turn the body: those up to the last of its axes on the side of the workpiece, or from the
/// first on the side of the tool. The rest of the chain stands on the carrying body.
std::size_t place_of_carrier(const ControlTwistGrid& grid) {
  const auto& joints = grid.machine.structure.joints;
  const auto of_grid = [&](const Joint& joint) {
    return std::find(grid.axes.begin(), grid.axes.end(), joint.axis) != grid.axes.end();
  };
  if (!grid.of_table)
    return static_cast<std::size_t>(std::find_if(joints.begin(), joints.end(), of_grid) - joints.begin());
  std::size_t behind = 0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (of_grid(joints[i])) behind = i + 1;
  }
  return behind;
}

/// Multilinear, axis after axis from the first.
Eigen::Matrix<double, 6, 1> twist_between(const ControlTwistGrid& grid, const MachineState& state,
                                          std::size_t axis, std::size_t offset) {
  if (axis == grid.axes.size()) return grid.twist.at(offset);
  const std::vector<double>& nodes = grid.nodes[axis];
  double q = state.position[index_of(grid.axes[axis])];
  if (grid.full_turn[axis]) q = within_period(q, nodes.front(), 2.0 * std::numbers::pi);
  const auto [upper, share] = interval_of(nodes, q);
  const std::size_t row = offset * nodes.size();
  if (upper == 0) return twist_between(grid, state, axis + 1, row);
  return (1.0 - share) * twist_between(grid, state, axis + 1, row + upper - 1) +
         share * twist_between(grid, state, axis + 1, row + upper);
}

}  // namespace

CommandCorrection model_correction(const ControlModel& model) {
  const CommandCorrection linear = linear_model_correction(model);
  if (model.rotary == RotaryModel::None) return linear;
  return [linear, rotary = rotary_model_correction(model)](const MachineState& state) {
    CommandMoves moves = linear(state);
    moves += rotary(state);
    return moves;
  };
}

CommandCorrection twist_correction(const ControlTwistGrid& given) {
  const auto grid = std::make_shared<const ControlTwistGrid>(given);
  const auto nominal = std::make_shared<const TruthMachine>(given.machine);
  const std::size_t carrier = place_of_carrier(given);
  return [grid, nominal, carrier](const MachineState& state) {
    const std::size_t joints = grid->machine.structure.joints.size();
    const Eigen::Matrix4d to_carrier = nominal_joints(grid->machine, state, 0, carrier);
    const Eigen::Matrix4d tool = nominal_joints(grid->machine, state, carrier, joints);
    const Eigen::Vector3d point = (tool * translation(grid->tool)).topRightCorner<3, 1>();
    const Eigen::Matrix<double, 6, 1> twist = sign_of(grid->meaning) * twist_between(*grid, state, 0, 0);
    const Eigen::Vector3d wanted =
        twist.head<3>() + Eigen::Vector3d(twist.tail<3>()).cross(point - grid->reference);
    return CommandMoves(moves_along(ways_of_linear_axes(*nominal, state, grid->tool),
                                    to_carrier.topLeftCorner<3, 3>() * wanted));
  };
}

}  // namespace volcal::sim
