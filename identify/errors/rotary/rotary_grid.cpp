#include "volcal/identify/errors/rotary/rotary_grid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kSameAngle = 1e-9;        // rad
constexpr double kSameAfterATurn = 1e-12;  // m or rad

bool repeats_after_a_turn(const FitResult& result, AxisName axis, double first) {
  const MeasuredTravel measured(result);
  AxisPosition start{}, end{};
  start[index_of(axis)] = first;
  end[index_of(axis)] = first + kTurn;
  const auto at = [&](const AxisPosition& position) {
    return pose_errors(result.layout, measured.held(position), result.parameters).motion[index_of(axis)];
  };
  const auto at_start = at(start), at_end = at(end);
  for (std::size_t i = 0; i < at_start.size(); ++i) {
    if (std::abs(at_start[i] - at_end[i]) > kSameAfterATurn) return false;
  }
  return true;
}

/// Rotary joints of one side that were identified, workpiece to tool.
std::vector<AxisName> turning_axes(const FitResult& result, bool workpiece_side) {
  const std::vector<AxisName> identified = identified_rotary_axes(result);
  std::vector<AxisName> axes;
  for (const Joint& joint : result.machine.structure.joints) {
    if (joint.workpiece_side != workpiece_side) continue;
    if (std::ranges::find(identified, joint.axis) != identified.end()) axes.push_back(joint.axis);
  }
  return axes;
}

/// Twists of one side.
class SideTwists {
 public:
  SideTwists(const FitResult& result, const Conditions& conditions, const std::vector<AxisName>& axes,
             bool workpiece_side, const RotaryShares& shares)
      : result_(result),
        chain_(result.machine),
        effects_(result, Tool{}, conditions),
        measured_(result),
        axes_(axes),
        workpiece_side_(workpiece_side),
        shares_(shares),
        reference_(result.machine.axis(workpiece_side ? axes.front() : axes.back()).centre) {}

  const Vector3d& reference() const { return reference_; }

  RotaryTwist at(const AxisPosition& position) const {
    const Vector3d tool = tool_at_reference(position);
    PoseErrorRows rows = PoseErrorRows::Zero(6, result_.layout.size);
    const AxisPosition held = measured_.held(position);
    const PoseErrorRows all = pose_error_rows(chain_, result_.layout, position, tool, held);
    for (const FunctionGroup& group : result_.layout.groups) {
      if (!is_turning(group.axis)) continue;
      for (int slot = 0; slot < group.count(); ++slot) {
        if (!counts(group.symbols[static_cast<std::size_t>(slot)], shares_.motion)) continue;
        for (int j = 0; j < group.basis->size(); ++j)
          rows.col(group.index(j, slot)) = all.col(group.index(j, slot));
      }
    }
    for (const ParameterBlock& block : result_.layout.blocks) {
      if (!block.location || !is_turning(block.location->axis)) continue;
      if (counts({block.location->component, block.location->axis}, shares_.location))
        rows.col(block.offset) = all.col(block.offset);
    }
    RotaryTwist twist;
    twist.value = rows * result_.parameters;
    add_effects(position, tool, held, rows, twist.value);
    twist.extrapolated = measured_.is_beyond(position);
    turn_into_carrier(position, rows, twist);
    return twist;
  }

 private:
  bool is_turning(AxisName axis) const { return std::ranges::find(axes_, axis) != axes_.end(); }
  bool counts(ErrorSymbol symbol, bool others) const {
    const bool own = is_rotation(symbol.component) && symbol.is_positioning();
    return own ? shares_.own : others;
  }

  /// Offset of a tool whose nominal functional point is the reference point.
  Vector3d tool_at_reference(const AxisPosition& position) const {
    if (workpiece_side_) return reference_;
    const Vector3d spindle = chain_.nominal_point_w(position, Vector3d::Zero());
    return chain_.nominal_rotation_wt(position).transpose() * (reference_ - spindle);
  }

  /// Effects on error motions of these axes, mean of both directions.
  void add_effects(const AxisPosition& position, const Vector3d& tool, const AxisPosition& held,
                   PoseErrorRows& rows, PoseErrorVector& value) const {
    if (effects_.empty()) return;
    JointLever levers[kAxisCount];
    chain_.levers(position, tool, levers);
    const ApproachDirection mean{};
    const Eigen::MatrixXd drivers = effects_.drivers_and_slopes({&held, 1}, {&mean, 1});
    for (std::size_t c = 0; c < effects_.columns().size(); ++c) {
      const EffectColumn& column = effects_.columns()[c];
      const bool of_axis = column.target.kind == TargetKind::Motion && is_turning(column.target.symbol.axis);
      if (!of_axis || !counts(column.target.symbol, shares_.motion)) continue;
      const JointLever& lever = *std::find_if(
          levers, levers + chain_.joint_count(),
          [&](const JointLever& candidate) { return candidate.axis == column.target.symbol.axis; });
      PoseErrorVector unit;
      unit << KinematicChain::motion_lever_w(lever, column.target.symbol.component),
          KinematicChain::motion_rotation_w(lever, column.target.symbol.component);
      const double driver = drivers(0, static_cast<Eigen::Index>(c));
      if (column.shape < 0) {
        value += unit * (driver * result_.parameters[column.parameter]);
        rows.col(column.parameter) += driver * unit;
      } else {
        rows.col(column.parameter) += driver * result_.parameters[column.amplitude_parameter] * unit;
      }
    }
  }

  /// From workpiece coordinates into those of the body that carries the axes.
  void turn_into_carrier(const AxisPosition& position, PoseErrorRows& rows, RotaryTwist& twist) const {
    if (workpiece_side_) {
      const Eigen::Matrix3d turn = chain_.nominal_rotation_wt(position).transpose();
      twist.value.head<3>() = (turn * twist.value.head<3>()).eval();
      twist.value.tail<3>() = (turn * twist.value.tail<3>()).eval();
      rows.topRows<3>() = (turn * rows.topRows<3>()).eval();
      rows.bottomRows<3>() = (turn * rows.bottomRows<3>()).eval();
    }
    twist.u = variances_of(rows).cwiseMax(0.0).cwiseSqrt();
  }

  /// Of the parameters that the rows have, few of all.
  PoseErrorVector variances_of(const PoseErrorRows& rows) const {
    std::vector<int> used;
    for (int c = 0; c < static_cast<int>(rows.cols()); ++c) {
      if (!rows.col(c).isZero(0.0)) used.push_back(c);
    }
    const PoseErrorRows own = rows(Eigen::all, used);
    const Eigen::MatrixXd covariance = covariance_of(result_, used);
    return (own * covariance).cwiseProduct(own).rowwise().sum();
  }

  const FitResult& result_;
  KinematicChain chain_;
  MachineEffects effects_;
  MeasuredTravel measured_;
  std::vector<AxisName> axes_;
  bool workpiece_side_;
  RotaryShares shares_;
  Vector3d reference_;
};

}  // namespace

std::string no_rotary_grid(const FitResult& result) {
  const std::vector<AxisName> identified = identified_rotary_axes(result);
  for (const bool workpiece_side : {true, false}) {
    bool turned = false, moved_since = false;
    for (const Joint& joint : result.machine.structure.joints) {
      if (joint.workpiece_side != workpiece_side) continue;
      const bool turns = std::ranges::find(identified, joint.axis) != identified.end();
      if (turns && moved_since)
        return "a linear axis stands between the rotary axes of " + result.machine.structure.code +
               ": what they do at a position depends on it too";
      turned |= turns;
      moved_since |= turned && !is_rotary(joint.axis);
    }
  }
  return {};
}

std::string_view to_string(TurnedBody body) { return body == TurnedBody::Table ? "table" : "tool"; }

RotaryNodes rotary_nodes(const FitResult& result, AxisName name, double largest_step) {
  const Axis& axis = result.machine.axis(name);
  RotaryNodes nodes;
  nodes.axis = name;
  nodes.full_turn =
      axis.travel() >= kTurn - kSameAngle && repeats_after_a_turn(result, name, axis.travel_min);
  const double length = nodes.full_turn ? kTurn : axis.travel();
  const int steps = std::max(1, static_cast<int>(std::ceil(length / largest_step - kSameAngle)));
  for (int i = 0; i <= steps; ++i) nodes.positions.push_back(axis.travel_min + length * i / steps);
  return nodes;
}

std::vector<AxisPosition> RotaryGrid::positions() const {
  std::vector<AxisPosition> all = {AxisPosition{}};
  for (const RotaryNodes& nodes : axes) {
    std::vector<AxisPosition> extended;
    for (const AxisPosition& position : all) {
      for (const double angle : nodes.positions) {
        extended.push_back(position);
        extended.back()[index_of(nodes.axis)] = angle;
      }
    }
    all = std::move(extended);
  }
  return all;
}

std::vector<RotaryGrid> rotary_grids(const FitResult& result, const Conditions& conditions,
                                     double largest_step, const RotaryShares& shares) {
  const std::string reason = no_rotary_grid(result);
  if (!reason.empty())
    throw InputError({}, "no grid of rotary axes: " + reason, "write tables of the errors of each axis: csv");
  std::vector<RotaryGrid> grids;
  for (const bool workpiece_side : {true, false}) {
    std::vector<AxisName> axes = turning_axes(result, workpiece_side);
    if (axes.empty()) continue;
    const SideTwists twists(result, conditions, axes, workpiece_side, shares);
    RotaryGrid grid;
    grid.body = workpiece_side ? TurnedBody::Table : TurnedBody::Tool;
    grid.reference = twists.reference();
    std::ranges::sort(axes);
    for (const AxisName axis : axes) grid.axes.push_back(rotary_nodes(result, axis, largest_step));
    for (const AxisPosition& position : grid.positions()) grid.twists.push_back(twists.at(position));
    grids.push_back(std::move(grid));
  }
  return grids;
}

}  // namespace volcal
