#include "volcal/model/kinematics/chain.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "volcal/model/kinematics/location_sign.h"

namespace volcal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double location_sign(const JointLever& lever, Component component) {
  return rotary_location_sign(lever.workpiece_side, lever.axis, component);
}

/// rotation_about() of a nominal angle, the same to the bit, with one sine and cosine.
Matrix3d nominal_rotation(int direction, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const int next = (direction + 1) % 3, last = (direction + 2) % 3;
  Matrix3d rotation = Matrix3d::Identity();
  rotation(next, next) = rotation(last, last) = c;
  rotation(last, next) = s;
  rotation(next, last) = -s;
  return rotation;
}

}  // namespace

const JointLever& joint_lever(const JointLever* levers, std::size_t count, AxisName axis) {
  return *std::find_if(levers, levers + count,
                       [axis](const JointLever& lever) { return lever.axis == axis; });
}

KinematicChain::KinematicChain(const Machine& machine) {
  joints_.reserve(machine.structure.joints.size());
  for (const Joint& joint : machine.structure.joints) {
    const Axis& axis = machine.axis(joint.axis);
    joints_.push_back({joint.axis, joint.workpiece_side, axis.reference_point, axis.centre});
  }
}

Vector3d KinematicChain::nominal_point_w(const AxisPosition& position, const Vector3d& tool_offset) const {
  Vector3d point = tool_offset;
  for (std::size_t i = joints_.size(); i-- > 0;) {
    const ChainJoint& joint = joints_[i];
    const double q = position[index_of(joint.axis)];
    const int direction = direction_of(joint.axis);
    if (is_rotary(joint.axis)) {
      point = (nominal_rotation(direction, q) * (point - joint.centre) + joint.centre).eval();
    } else {
      point[direction] += q;
    }
  }
  return point;
}

Matrix3d KinematicChain::nominal_rotation_wt(const AxisPosition& position) const {
  Matrix3d rotation = Matrix3d::Identity();
  for (const ChainJoint& joint : joints_) {
    if (!is_rotary(joint.axis)) continue;
    rotation = (rotation * nominal_rotation(direction_of(joint.axis), position[index_of(joint.axis)])).eval();
  }
  return rotation;
}

Vector3d KinematicChain::levers(const AxisPosition& position, const Vector3d& tool_offset,
                                JointLever* levers) const {
  // Tool to workpiece: `point` is the nominal functional point in the coordinates right of the joint.
  Vector3d point = tool_offset;
  for (std::size_t i = joints_.size(); i-- > 0;) {
    const ChainJoint& joint = joints_[i];
    JointLever& lever = levers[i];
    lever.axis = joint.axis;
    lever.workpiece_side = joint.workpiece_side;
    lever.position = position[index_of(joint.axis)];
    const int direction = direction_of(joint.axis);
    if (is_rotary(joint.axis)) {
      const Vector3d radius = point - joint.centre;
      const Vector3d turned = nominal_rotation(direction, lever.position) * radius;
      lever.arm_s = joint.workpiece_side ? radius : turned;
      point = turned + joint.centre;
    } else {
      const Vector3d before = point - joint.reference_point;
      point[direction] += lever.position;
      lever.arm_s = joint.workpiece_side ? Vector3d(point - joint.reference_point) : before;
    }
  }
  // Workpiece to tool: rotation of the rotary joints nearer the workpiece.
  Matrix3d rotation = Matrix3d::Identity();
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    JointLever& lever = levers[i];
    lever.rotation_ws = rotation;
    if (!is_rotary(lever.axis)) continue;
    rotation = (rotation * nominal_rotation(direction_of(lever.axis), lever.position)).eval();
    if (lever.workpiece_side) lever.rotation_ws = rotation;
  }
  return point;
}

namespace {

/// Of the positions of a rotary axis.
struct Turns {
  Lanes cosine, sine;
};

Turns turns_of(const Lanes& angle) {
  Turns turns;
  find_unit_vectors(angle, turns.cosine, turns.sine);
  return turns;
}

/// v = R v, R about a coordinate axis.
void turn_vector(const Turns& turns, int direction, Lanes* v) {
  turn(turns.cosine, turns.sine, v[(direction + 1) % 3], v[(direction + 2) % 3]);
}

/// M = M R, M row by row.
void turn_frame(const Turns& turns, int direction, Lanes* m) {
  for (int row = 0; row < 3; ++row)
    turn(turns.cosine, turns.sine, m[3 * row + (direction + 2) % 3], m[3 * row + (direction + 1) % 3]);
}

void add_vector(const Vector3d& v, double sign, Lanes* to) {
  for (int k = 0; k < 3; ++k) add_number(sign * v[k], to[k]);
}

/// Of the stator frames, workpiece to tool. `turns`: of the joints that are rotary.
template <class Joints>
void find_rotations(const Joints& joints, const Turns* turns, Lanes* rotation_ws) {
  Lanes rotation[9];
  for (int k = 0; k < 9; ++k) rotation[k].fill(k % 4 == 0 ? 1.0 : 0.0);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const bool turns_itself = is_rotary(joints[i].axis), workpiece_side = joints[i].workpiece_side;
    const int direction = direction_of(joints[i].axis);
    if (turns_itself && workpiece_side) turn_frame(turns[i], direction, rotation);
    std::copy_n(rotation, 9, rotation_ws + 9 * i);
    if (turns_itself && !workpiece_side) turn_frame(turns[i], direction, rotation);
  }
}

}  // namespace

void KinematicChain::levers(const Lanes* position, const Vector3d& tool_offset, Lanes* point_w, Lanes* arm_s,
                            Lanes* rotation_ws) const {
  std::array<Turns, kAxisCount> turns;  // of the joints that are rotary
  for (int k = 0; k < 3; ++k) point_w[k].fill(tool_offset[k]);
  for (std::size_t i = joints_.size(); i-- > 0;) {
    const ChainJoint& joint = joints_[i];
    const Lanes& q = position[index_of(joint.axis)];
    const int direction = direction_of(joint.axis);
    Lanes* const arm = arm_s + 3 * i;
    if (is_rotary(joint.axis)) {
      turns[i] = turns_of(q);
      add_vector(joint.centre, -1.0, point_w);
      if (joint.workpiece_side) std::copy_n(point_w, 3, arm);
      turn_vector(turns[i], direction, point_w);
      if (!joint.workpiece_side) std::copy_n(point_w, 3, arm);
      add_vector(joint.centre, 1.0, point_w);
    } else {
      if (joint.workpiece_side) add_scaled(q, 1.0, point_w[direction]);
      std::copy_n(point_w, 3, arm);
      if (!joint.workpiece_side) add_scaled(q, 1.0, point_w[direction]);
      add_vector(joint.reference_point, -1.0, arm);
    }
  }
  if (rotation_ws != nullptr) find_rotations(joints_, turns.data(), rotation_ws);
}

ToolTwist KinematicChain::first_order(const AxisPosition& position, const Vector3d& tool_offset,
                                      const PoseErrors<double>& errors) const {
  JointLever joint_levers[kAxisCount];
  levers(position, tool_offset, joint_levers);
  ToolTwist twist;
  for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
    const JointLever& lever = joint_levers[joint];
    const auto& motion = errors.motion[index_of(lever.axis)];
    const auto& location = errors.location[index_of(lever.axis)];
    Vector3d displacement(motion[0], motion[1], motion[2]), rotation(motion[3], motion[4], motion[5]);
    const Vector3d orientation(location[3], location[4], location[5]);
    if (is_rotary(lever.axis)) {
      for (const Component component : kAllComponents) {
        const double value = location_sign(lever, component) * location[index_of(component)];
        (is_rotation(component) ? rotation : displacement)[direction_of(component)] += value;
      }
    } else {
      displacement += lever.position * orientation.cross(Vector3d::Unit(direction_of(lever.axis)));
    }
    Vector3d& rotation_w =
        lever.workpiece_side ? twist.rotation_workpiece_side_w : twist.rotation_tool_side_w;
    twist.displacement_w += lever.rotation_ws * (displacement + rotation.cross(lever.arm_s));
    rotation_w += lever.rotation_ws * rotation;
  }
  return twist;
}

Vector3d KinematicChain::motion_lever_w(const JointLever& lever, Component component) {
  const Vector3d unit = Vector3d::Unit(direction_of(component));
  if (!is_rotation(component)) return lever.rotation_ws * unit;
  return lever.rotation_ws * unit.cross(lever.arm_s);
}

Vector3d KinematicChain::motion_rotation_w(const JointLever& lever, Component component) {
  if (!is_rotation(component)) return Vector3d::Zero();
  return lever.rotation_ws.col(direction_of(component));
}

Vector3d KinematicChain::location_lever_w(const JointLever& lever, Component component) {
  if (is_rotary(lever.axis)) return location_sign(lever, component) * motion_lever_w(lever, component);
  if (!is_rotation(component)) return Vector3d::Zero();
  const Vector3d unit = Vector3d::Unit(direction_of(component));
  return lever.rotation_ws * unit.cross(Vector3d::Unit(direction_of(lever.axis))) * lever.position;
}

Vector3d KinematicChain::location_rotation_w(const JointLever& lever, Component component) {
  if (!is_rotary(lever.axis)) return Vector3d::Zero();
  return location_sign(lever, component) * motion_rotation_w(lever, component);
}

}  // namespace volcal
