#include "volcal/identify/compensation/five_axis_compensation.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/identify/compensation/compensation.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Part = CompensationPart;

constexpr double kHardlyMoved = 0.05;  // singular value of the linear axes' directions
constexpr double kTurning = 0.1;       // singular value of the rotary axes' turns of the tool's axis
constexpr double kOrthogonal = 1e-12;  // of the linear axes' directions
constexpr double kNewtonStop = 1e-12;  // m
constexpr int kNewtonSteps = 8;
constexpr int kOrientationSteps = 4;

std::size_t rotary_index(AxisName axis) { return index_of(axis) - 3; }

Vector3d without_component(Vector3d v, int direction) {
  v[direction] = 0.0;
  return v;
}

/// Two unit vectors across a unit vector.
Eigen::Matrix<double, 3, 2> across(const Vector3d& t) {
  Eigen::Index smallest = 0;
  t.cwiseAbs().minCoeff(&smallest);
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = t.cross(Vector3d::Unit(smallest)).normalized();
  basis.col(1) = t.cross(basis.col(0));
  return basis;
}

}  // namespace

struct FiveAxisCompensation::Levers {
  std::array<JointLever, kAxisCount> joints;
  std::array<JointLever, kAxisCount> at_reference;  ///< with the reference tool
  std::size_t count = 0;
  Vector3d point_w;                      ///< nominal
  Vector3d axis_w;                       ///< nominal direction of the tool's axis
  Matrix3d linear_w = Matrix3d::Zero();  ///< directions of X, Y, Z
  Matrix3d rotary_w = Matrix3d::Zero();  ///< axes of A, B, C
};

/// First-order displacements, workpiece coordinates.
struct FiveAxisCompensation::Shares {
  Vector3d rotary = Vector3d::Zero();       ///< that R-types correct by the linear axes
  Vector3d linear = Vector3d::Zero();       ///< that L-VOL corrects
  Vector3d uncorrected = Vector3d::Zero();  ///< the rest, without what R-POS corrects
  Vector3d own = Vector3d::Zero();          ///< rotation of A, B, C about themselves, rad
};

FiveAxisCompensation::FiveAxisCompensation(const Machine& machine, const FiveAxisSettings& settings,
                                           JointErrorSource errors)
    : chain_(machine), settings_(settings), errors_(std::move(errors)) {
  centre_.fill(Vector3d::Zero());
  for (const Axis& axis : machine.axes) {
    if (is_rotary(axis.name)) centre_[rotary_index(axis.name)] = axis.centre;
  }
  if (settings_.type.has(Part::Orientation)) require_turning_axes(machine);
  const bool has_table = outermost_table_axis(machine.structure).has_value();
  if (!settings_.type.is_volumetric() || (has_table && settings_.type.has(Part::RotaryLocation))) return;
  const AxisPosition home = home_of(machine);
  const Levers at = levers_at(home);
  home_moves_ = linear_moves(at.linear_w, shares_at(home, kTowardsPlus, at).linear);
}

FiveAxisCompensation::Levers FiveAxisCompensation::levers_at(const AxisPosition& position) const {
  Levers at;
  at.count = chain_.joint_count();
  at.point_w = chain_.levers(position, settings_.tool_offset, at.joints.data());
  at.at_reference = at.joints;
  if (settings_.reference.tool_offset)
    chain_.levers(position, *settings_.reference.tool_offset, at.at_reference.data());
  at.axis_w = chain_.nominal_rotation_wt(position).col(2);
  for (std::size_t i = 0; i < at.count; ++i) {
    const JointLever& lever = at.joints[i];
    const int direction = direction_of(lever.axis);
    if (is_rotary(lever.axis)) at.rotary_w.col(direction) = lever.rotation_ws.col(direction);
  }
  at.linear_w = linear_directions(at.joints.data(), at.count);
  return at;
}

/// From the axis' centre, stator frame.
Vector3d FiveAxisCompensation::reference_arm(const JointLever& lever, const Levers& at) const {
  if (lever.workpiece_side)
    return settings_.reference.elevation[rotary_index(lever.axis)] * Vector3d::Unit(direction_of(lever.axis));
  const auto* const found = std::find_if(at.at_reference.begin(), at.at_reference.end(),
                                         [&](const JointLever& other) { return other.axis == lever.axis; });
  return found->arm_s;
}

void FiveAxisCompensation::add_rotary(const JointLever& lever, const Levers& at,
                                      const PoseErrors<double>& errors, Shares& shares) const {
  const auto& motion = errors.motion[index_of(lever.axis)];
  const auto& location = errors.location[index_of(lever.axis)];
  const int own = direction_of(lever.axis);
  const Vector3d e(motion[0], motion[1], motion[2]), dp(location[0], location[1], location[2]);
  const Vector3d tilt = without_component({motion[3], motion[4], motion[5]}, own);
  const Vector3d alpha = without_component({location[3], location[4], location[5]}, own);
  const double own_rotation =
      motion[static_cast<std::size_t>(own) + 3] + location[static_cast<std::size_t>(own) + 3];
  const Vector3d reference = reference_arm(lever, at);
  const double sign = lever.workpiece_side ? -1.0 : 1.0;
  const auto add = [&](Part part, const Vector3d& displacement_s) {
    (settings_.type.has(part) ? shares.rotary : shares.uncorrected) += lever.rotation_ws * displacement_s;
  };
  add(Part::RotaryRadialAxial, e + tilt.cross(reference));
  add(Part::RotaryAngular, tilt.cross(lever.arm_s - reference));
  add(Part::RotaryLocation, sign * (dp + alpha.cross(lever.arm_s)));
  shares.own[own] = own_rotation;
  if (!settings_.turns_axes || !settings_.type.has(Part::RotaryPositioning))
    add(Part::RotaryPositioning, (own_rotation * Vector3d::Unit(own)).cross(lever.arm_s));
}

FiveAxisCompensation::Shares FiveAxisCompensation::shares_at(const AxisPosition& position,
                                                             const ApproachDirection& direction,
                                                             const Levers& at) const {
  const PoseErrors<double> errors = errors_(position, direction);
  Shares shares;
  for (std::size_t i = 0; i < at.count; ++i) {
    const JointLever& lever = at.joints[i];
    if (is_rotary(lever.axis)) {
      add_rotary(lever, at, errors, shares);
      continue;
    }
    Vector3d displacement = Vector3d::Zero();
    for (const Component component : kAllComponents) {
      displacement += errors.motion[index_of(lever.axis)][index_of(component)] *
                          KinematicChain::motion_lever_w(lever, component) +
                      errors.location[index_of(lever.axis)][index_of(component)] *
                          KinematicChain::location_lever_w(lever, component);
    }
    (settings_.type.is_volumetric() ? shares.linear : shares.uncorrected) += displacement;
  }
  return shares;
}

std::optional<AxisName> outermost_table_axis(const Structure& structure) {
  std::optional<AxisName> outermost;
  for (const Joint& joint : structure.joints) {  // workpiece to tool
    if (joint.workpiece_side && is_rotary(joint.axis)) outermost = joint.axis;
  }
  return outermost;
}

Matrix3d linear_directions(const JointLever* levers, std::size_t count) {
  Matrix3d directions = Matrix3d::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const int direction = direction_of(levers[i].axis);
    if (is_rotary(levers[i].axis) || is_parallel(levers[i].axis)) continue;
    directions.col(direction) = levers[i].rotation_ws.col(direction);
  }
  return directions;
}

Vector3d linear_moves(const Matrix3d& directions, const Vector3d& displacement_w) {
  if ((directions.transpose() * directions - Matrix3d::Identity()).cwiseAbs().maxCoeff() < kOrthogonal)
    return directions.transpose() * displacement_w;
  Eigen::JacobiSVD<Matrix3d> svd(directions, Eigen::ComputeFullU | Eigen::ComputeFullV);
  svd.setThreshold(kHardlyMoved / std::max(svd.singularValues()[0], kHardlyMoved));
  return svd.solve(displacement_w);
}

KinematicChain::Pose<double> FiveAxisCompensation::exact_pose(const AxisPosition& programmed,
                                                              const Correction& correction,
                                                              const ApproachDirection& direction) const {
  const AxisPosition commanded = correction.applied_to(programmed);
  return chain_.exact_pose<double>(commanded, settings_.tool_offset, errors_(commanded, direction));
}

/// Moves of A, B, C beside those of `others`.
Vector3d FiveAxisCompensation::orientation_moves(const Levers& at, const AxisPosition& position,
                                                 const ApproachDirection& direction,
                                                 const Correction& others) const {
  const Eigen::Matrix<double, 3, 2> basis = across(at.axis_w);
  Eigen::Matrix<double, 2, 3> turns;
  for (Eigen::Index k = 0; k < 3; ++k)
    turns.col(k) = basis.transpose() * Vector3d(at.rotary_w.col(k)).cross(at.axis_w);
  const Eigen::Matrix2d normal =
      turns * turns.transpose() + settings_.damping * settings_.damping * Eigen::Matrix2d::Identity();
  Vector3d moves = Vector3d::Zero();
  for (int step = 0; step < kOrientationSteps; ++step) {
    Correction all = others;
    all.rotary += moves;
    const Vector3d axis_w = exact_pose(position, all, direction).rotation_wt.col(2);
    const Eigen::Vector2d without_moves = basis.transpose() * (axis_w - at.axis_w) - turns * moves;
    moves = -turns.transpose() * normal.inverse() * without_moves;
  }
  return moves;
}

/// Moves of X, Y, Z that bring the functional point where it is but for what the type leaves.
Vector3d FiveAxisCompensation::exact_linear_moves(const Levers& at, const Shares& shares,
                                                  const AxisPosition& position,
                                                  const ApproachDirection& direction,
                                                  const Correction& start) const {
  const Vector3d target_w = at.point_w + shares.uncorrected;
  Correction all = start;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Vector3d missing_w = target_w - exact_pose(position, all, direction).point_w;
    all.linear += linear_moves(at.linear_w, missing_w);
    if (missing_w.norm() < kNewtonStop) break;
  }
  return all.linear;
}

Correction FiveAxisCompensation::correction(const AxisPosition& position,
                                            const ApproachDirection& direction) const {
  const Levers at = levers_at(position);
  const Shares shares = shares_at(position, direction, at);
  Correction correction;
  correction.linear = -linear_moves(at.linear_w, shares.rotary + shares.linear);
  if (settings_.turns_axes && settings_.type.has(Part::RotaryPositioning)) correction.rotary = -shares.own;
  if (settings_.type.has(Part::Orientation)) {
    correction.rotary += orientation_moves(at, position, direction, correction);
    if (settings_.type.has(Part::Angular) || settings_.type.has(Part::RotaryAngular))
      correction.linear = exact_linear_moves(at, shares, position, direction, correction);
  }
  correction.linear += home_moves_;
  return correction;
}

Vector3d FiveAxisCompensation::displacement_w(const AxisPosition& position,
                                              const ApproachDirection& direction) const {
  const Shares shares = shares_at(position, direction, levers_at(position));
  return shares.rotary + shares.linear;
}

FiveAxisCompensation::Left FiveAxisCompensation::left_by(const Correction& correction,
                                                         const AxisPosition& position,
                                                         const ApproachDirection& direction) const {
  const Levers at = levers_at(position);
  const KinematicChain::Pose<double> pose = exact_pose(position, correction, direction);
  const Vector3d axis_w = pose.rotation_wt.col(2);
  return {pose.point_w - at.point_w, std::atan2(axis_w.cross(at.axis_w).norm(), axis_w.dot(at.axis_w)),
          axis_w};
}

Vector3d FiveAxisCompensation::nominal_axis_w(const AxisPosition& position) const {
  return levers_at(position).axis_w;
}

/// In one of several poses two rotary axes must turn the tool's axis in two directions.
void FiveAxisCompensation::require_turning_axes(const Machine& machine) const {
  bool turns_it = false;
  for (const double angle : {0.3, 0.7, 1.1}) {
    AxisPosition position{};
    position[3] = angle;
    position[4] = 1.5 * angle;
    position[5] = 0.5 * angle;
    const Levers at = levers_at(position);
    Matrix3d turns;
    for (Eigen::Index k = 0; k < 3; ++k) turns.col(k) = Vector3d(at.rotary_w.col(k)).cross(at.axis_w);
    turns_it |= Eigen::JacobiSVD<Matrix3d>(turns).singularValues()[1] > kTurning;
  }
  if (machine.main_linear_axes().size() == 3 && turns_it) return;
  throw InputError(
      {},
      settings_.type.name() + " on " + machine.structure.code +
          ": FOR needs three linear axes and two rotary axes that are not parallel to the tool's "
          "axis (ISO/TR 16907, 8.2.6)",
      "leave FOR out: L-VOL in place of L-VOL+, R-VOL in place of R-VOL+");
}

JointErrorSource joint_errors(const FitResult& result, const Tool& tool, const Conditions& conditions) {
  return [field = ErrorField(result, tool, conditions)](const AxisPosition& position,
                                                        const ApproachDirection& direction) {
    return field.joint_errors(position, direction);
  };
}

JointErrorSource joint_and_tool_errors(const FitResult& result, const Tool& tool,
                                       const Conditions& conditions) {
  const auto table = outermost_table_axis(result.machine.structure);
  if (!table) return joint_errors(result, tool, conditions);
  return [field = ErrorField(result, tool, conditions), chain = KinematicChain(result.machine),
          table = *table](const AxisPosition& position, const ApproachDirection& direction) {
    PoseErrors<double> errors = field.joint_errors(position, direction);
    const Vector3d offset_t = field.tool_displacement(position, direction);
    if (offset_t.isZero(0.0)) return errors;
    JointLever levers[kAxisCount];
    chain.levers(position, Vector3d::Zero(), levers);
    const Matrix3d& rotation_ws = joint_lever(levers, chain.joint_count(), table).rotation_ws;
    const Vector3d displacement_s =
        rotation_ws.transpose() * (chain.nominal_rotation_wt(position) * offset_t);
    for (std::size_t k = 0; k < 3; ++k)
      errors.location[index_of(table)][k] -= displacement_s[static_cast<Eigen::Index>(k)];
    return errors;
  };
}

}  // namespace volcal
