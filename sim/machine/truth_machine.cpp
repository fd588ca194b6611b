#include "volcal/sim/machine/truth_machine.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "volcal/sim/machine/transforms.h"

namespace volcal::sim {
namespace {

LocationSymbol location_symbol(int component, AxisName axis) {
  return {kAllComponents[static_cast<std::size_t>(component)], axis};
}

}  // namespace

std::vector<LocationSymbol> linear_locations(const Machine& machine, AxisName axis) {
  std::vector<LocationSymbol> angles;
  if (is_parallel(axis)) {
    for (int about = 0; about < 3; ++about) {
      if (about != direction_of(axis)) angles.push_back(location_symbol(3 + about, axis));
    }
    return angles;
  }
  for (const LocationSymbol& symbol : machine.datum.squareness()) {
    if (symbol.axis == axis) angles.push_back(symbol);
  }
  return angles;
}

double MachineState::feed() const {
  const auto along = [this](AxisName main, AxisName parallel) {
    return velocity[index_of(main)] + velocity[index_of(parallel)];
  };
  return std::hypot(along(AxisName::X, AxisName::U), along(AxisName::Y, AxisName::V),
                    along(AxisName::Z, AxisName::W));
}

TruthMachine::TruthMachine(Machine machine) : machine_(std::move(machine)) {
  for (const Joint& joint : machine_.structure.joints) {
    if (!machine_.has_axis(joint.axis)) {
      throw std::invalid_argument(std::string("the machine does not describe axis ") + letter_of(joint.axis));
    }
  }
}

void TruthMachine::set_error(ErrorSymbol symbol, ErrorFunction function) {
  machine_.axis(symbol.axis);
  functions_[symbol] = std::move(function);
}

void TruthMachine::require_location(LocationSymbol symbol) const {
  machine_.axis(symbol.axis);
  if (is_rotary(symbol.axis)) return;
  const auto angles = linear_locations(machine_, symbol.axis);
  if (std::ranges::find(angles, symbol) == angles.end())
    throw std::invalid_argument(symbol.name() + " is not a squareness of this datum");
}

void TruthMachine::set_location(LocationSymbol symbol, double value) {
  require_location(symbol);
  locations_[symbol] = value;
}

void TruthMachine::add_location_change(LocationSymbol symbol, StateError change) {
  require_location(symbol);
  location_changes_[symbol].push_back(std::move(change));
}

void TruthMachine::set_reversal(ErrorSymbol symbol, double reversal) {
  machine_.axis(symbol.axis);
  reversals_[symbol] = reversal;
}

void TruthMachine::set_scale_expansion(AxisName axis, double per_kelvin, const std::string& channel) {
  const double home = machine_.axis(axis).home;
  const ErrorSymbol positioning{positioning_component(axis), axis};
  expansions_[positioning].emplace_back([=](const MachineState& state) {
    const auto found = state.temperature.find(channel);
    if (found == state.temperature.end()) {
      throw std::invalid_argument("no temperature of channel " + channel);
    }
    return per_kelvin * (found->second - kReferenceTemperature) * (state.position[index_of(axis)] - home);
  });
}

void TruthMachine::hold_beyond(AxisName axis, double first, double last, bool round) {
  measured_[machine_.axis(axis).name] = {first, last, round};
}

double TruthMachine::MeasuredPart::nearest(double position) const {
  if (position >= first && position <= last) return position;
  double best = std::clamp(position, first, last);
  if (!round) return best;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  double way = std::abs(position - best);
  const int turns = 1 + static_cast<int>(way / kTurn);
  for (int k = -turns; k <= turns; ++k) {
    const double same = position + k * kTurn, held = std::clamp(same, first, last);
    if (std::abs(same - held) >= way) continue;
    best = held;
    way = std::abs(same - held);
  }
  return best;
}

MachineState TruthMachine::held(const MachineState& state) const {
  MachineState at = state;
  for (const auto& [axis, part] : measured_) {
    double& position = at.position[index_of(axis)];
    position = part.nearest(position);
  }
  return at;
}

void TruthMachine::add_state_error(ErrorSymbol symbol, StateError error) {
  machine_.axis(symbol.axis);
  state_errors_[symbol].push_back(std::move(error));
}

void TruthMachine::set_correction(CommandCorrection correction) { correction_ = std::move(correction); }

double TruthMachine::function_value(ErrorSymbol symbol, double position) const {
  const auto found = functions_.find(symbol);
  return found == functions_.end() ? 0.0 : found->second(position);
}

double TruthMachine::location(LocationSymbol symbol) const {
  const auto found = locations_.find(symbol);
  return found == locations_.end() ? 0.0 : found->second;
}

double TruthMachine::location(LocationSymbol symbol, const MachineState& state) const {
  double sum = location(symbol);
  const auto changes = location_changes_.find(symbol);
  if (changes == location_changes_.end()) return sum;
  for (const StateError& change : changes->second) sum += change(measured_.empty() ? state : held(state));
  return sum;
}

double TruthMachine::reversal(ErrorSymbol symbol) const {
  const auto found = reversals_.find(symbol);
  return found == reversals_.end() ? 0.0 : found->second;
}

double TruthMachine::error(ErrorSymbol symbol, const MachineState& state) const {
  return measured_.empty() ? error(symbol, state, state) : error(symbol, held(state), state);
}

double TruthMachine::error(ErrorSymbol symbol, const MachineState& at, const MachineState& state) const {
  const std::size_t axis = index_of(symbol.axis);
  double sum = function_value(symbol, at.position[axis]) + 0.5 * reversal(symbol) * at.direction[axis];
  const auto add = [&](const auto& errors, const MachineState& where) {
    const auto found = errors.find(symbol);
    if (found == errors.end()) return;
    for (const StateError& contribution : found->second) sum += contribution(where);
  };
  add(state_errors_, at);
  add(expansions_, state);
  return sum;
}

Eigen::Vector3d TruthMachine::direction_of_travel(AxisName axis, const MachineState& state) const {
  Eigen::Vector3d u = unit(axis);
  for (const LocationSymbol& symbol : linear_locations(machine_, axis))
    u += location(symbol, state) * Eigen::Vector3d::Unit(direction_of(symbol.component)).cross(unit(axis));
  return u.normalized();
}

Eigen::Matrix4d TruthMachine::joint_transform(const Joint& joint, const MachineState& state) const {
  const Axis& axis = machine_.axis(joint.axis);
  std::array<double, 6> e{};
  for (const Component component : kAllComponents) {
    e[index_of(component)] = error({component, joint.axis}, state);
  }
  const Eigen::Matrix4d motion = translation({e[0], e[1], e[2]}) * rotation_321({e[3], e[4], e[5]});
  const double q = state.position[index_of(joint.axis)];
  if (!is_rotary(joint.axis)) {
    const Eigen::Vector3d& r = axis.reference_point;
    const Eigen::Matrix4d travel = translation(q * direction_of_travel(joint.axis, state));
    const Eigen::Matrix4d at_reference = translation(r) * motion * translation(-r);
    return joint.workpiece_side ? at_reference * travel : travel * at_reference;
  }
  const int own = direction_of(joint.axis);
  const auto location_error = [&](int component) {
    return location(location_symbol(component, joint.axis), state);
  };
  const Eigen::Vector3d shift{location_error(0), location_error(1), location_error(2)};
  Eigen::Vector3d tilt{location_error(3), location_error(4), location_error(5)};
  const Eigen::Matrix4d turn = rotation_about(own, q + tilt[own]);
  tilt[own] = 0.0;
  const Eigen::Vector3d& c = axis.centre;
  const Eigen::Matrix4d line = translation(c + shift) * rotation_321(tilt);
  return joint.workpiece_side ? translation(c) * turn * motion * inverse(line)
                              : line * motion * turn * translation(-c);
}

Eigen::Matrix4d TruthMachine::nominal_joint_transform(const Joint& joint, const MachineState& state) const {
  const double q = state.position[index_of(joint.axis)];
  if (!is_rotary(joint.axis)) return translation(q * unit(joint.axis));
  const Eigen::Vector3d& c = machine_.axis(joint.axis).centre;
  return translation(c) * rotation_about(direction_of(joint.axis), q) * translation(-c);
}

MachineState TruthMachine::corrected(const MachineState& state) const {
  MachineState actual = state;
  if (!correction_) return actual;
  const CommandMoves added = correction_(state);
  for (const Joint& joint : machine_.structure.joints) {
    const AxisName axis = joint.axis;
    if (is_parallel(axis)) continue;
    actual.position[index_of(axis)] += (is_rotary(axis) ? added.rotary : added.linear)[direction_of(axis)];
  }
  return actual;
}

Eigen::Matrix4d TruthMachine::chain(Side side, bool nominal, const MachineState& programmed) const {
  const MachineState state = nominal ? programmed : corrected(programmed);
  Eigen::Matrix4d product = Eigen::Matrix4d::Identity();
  for (const Joint& joint : machine_.structure.joints) {
    if (side != Side::Both && joint.workpiece_side != (side == Side::Workpiece)) continue;
    product *= nominal ? nominal_joint_transform(joint, state) : joint_transform(joint, state);
  }
  return product;
}

Eigen::Matrix4d TruthMachine::pose(const MachineState& state, const Eigen::Vector3d& tool_offset) const {
  return chain(Side::Both, false, state) * translation(tool_offset);
}

Eigen::Matrix4d TruthMachine::nominal_pose(const MachineState& state,
                                           const Eigen::Vector3d& tool_offset) const {
  return chain(Side::Both, true, state) * translation(tool_offset);
}

Eigen::Vector3d TruthMachine::point(const MachineState& state, const Eigen::Vector3d& tool_offset) const {
  return pose(state, tool_offset).topRightCorner<3, 1>();
}

Eigen::Vector3d TruthMachine::nominal_point(const MachineState& state,
                                            const Eigen::Vector3d& tool_offset) const {
  return nominal_pose(state, tool_offset).topRightCorner<3, 1>();
}

Eigen::Vector3d TruthMachine::point_error(const MachineState& state,
                                          const Eigen::Vector3d& tool_offset) const {
  return point(state, tool_offset) - nominal_point(state, tool_offset);
}

Eigen::Matrix3d TruthMachine::nominal_tool_axes(const MachineState& state) const {
  return chain(Side::Both, true, state).topLeftCorner<3, 3>();
}

Eigen::Matrix3d TruthMachine::nominal_bed_axes(const MachineState& state) const {
  return chain(Side::Workpiece, true, state).topLeftCorner<3, 3>();
}

Eigen::Vector3d TruthMachine::relative_rotation(const MachineState& state) const {
  return rotation_vector(
      (chain(Side::Both, false, state) * inverse(chain(Side::Both, true, state))).topLeftCorner<3, 3>());
}

Eigen::Vector3d TruthMachine::tool_rotation(const MachineState& state) const {
  return rotation_vector(
      (chain(Side::Tool, false, state) * inverse(chain(Side::Tool, true, state))).topLeftCorner<3, 3>());
}

Eigen::Vector3d TruthMachine::table_rotation(const MachineState& state) const {
  return rotation_vector((inverse(chain(Side::Workpiece, false, state)) * chain(Side::Workpiece, true, state))
                             .topLeftCorner<3, 3>());
}

}  // namespace volcal::sim
