#pragma once
/// Kinematic chain of a machine: nominal point, exact pose (homogeneous transforms) and first-order error
/// twists. Workpiece coordinates `w`, machine coordinates at all axes zero; m and rad.
///
/// Exact: p_w = D_1 ... D_n tool, with (Bhattacharyya et al. eq. 6-8 for the 3-2-1 rotation E)
///   linear, tool side        D = T(q u) T(r) E T(-r)
///   linear, workpiece side   D = T(r) E T(-r) T(q u)
///   rotary, tool side        D = T(c + dc) R_o E Rot(q') T(-c)
///   rotary, workpiece side   D = T(c) Rot(q') E R_o^-1 T(-(c + dc))
/// First order (Zhao, Li and Tang 2011, error twists):
///   dP_w = sum_i R_(w<-i) [d_i + e_i x arm_i + q_i (u_i - e_i)]
/// The two differ by second order. With A the sum of |angular errors| (squareness included), D the sum of
/// |displacements| and L the longest arm or travel, the functional points differ by at most
/// (A^2 L / 2 + A D)(1 + A), the orientations by A^2 / 2 (1 + A); tested for random chains.
/// The constructor throws std::out_of_range when the machine does not describe an axis of its structure.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <vector>

#include "volcal/model/description/machine.h"
#include "volcal/model/kinematics/lanes.h"

namespace volcal {

/// Position of every axis, m or rad, by AxisName; axes that the machine lacks are ignored.
using AxisPosition = std::array<double, kAxisCount>;

/// Values of all errors at one pose, m and rad. `motion[axis][component]`; `location[axis][component]` holds
/// squareness (rotation components of linear axes, per the datum) and rotary location errors.
template <class T>
struct PoseErrors {
  std::array<std::array<T, 6>, kAxisCount> motion{};
  std::array<std::array<T, 6>, kAxisCount> location{};
};

/// Sensitivity of the tool's pose to one joint's errors: displacement d at the arm's foot and rotation e,
/// both in the joint's stator frame s, move the functional point by R_ws (d + e x arm_s) and turn the tool by
/// R_ws e.
struct JointLever {
  AxisName axis = AxisName::X;
  bool workpiece_side = false;
  double position = 0.0;
  Eigen::Matrix3d rotation_ws = Eigen::Matrix3d::Identity();
  Eigen::Vector3d arm_s = Eigen::Vector3d::Zero();
};

/// The lever of an axis, which must be among the `count` levers.
const JointLever& joint_lever(const JointLever* levers, std::size_t count, AxisName axis);

/// First-order displacement and rotation of the tool, split by side of the bed; workpiece coordinates.
struct ToolTwist {
  Eigen::Vector3d displacement_w = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_tool_side_w = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_workpiece_side_w = Eigen::Vector3d::Zero();
};

/// Rotation E of the 3-2-1 convention, Rz(c) Ry(b) Rx(a), exact (Bhattacharyya et al. eq. 6-8).
template <class T>
Eigen::Matrix<T, 3, 3> rotation_321(const T& a, const T& b, const T& c) {
  using std::cos;
  using std::sin;
  const T ca = cos(a), sa = sin(a), cb = cos(b), sb = sin(b), cc = cos(c), sc = sin(c);
  Eigen::Matrix<T, 3, 3> r;
  r << cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa,  //
      sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa,   //
      -sb, cb * sa, cb * ca;
  return r;
}

/// Rotation by `angle` about coordinate direction 0..2.
template <class T>
Eigen::Matrix<T, 3, 3> rotation_about(int direction, const T& angle) {
  const T zero(0.0);
  return rotation_321<T>(direction == 0 ? angle : zero, direction == 1 ? angle : zero,
                         direction == 2 ? angle : zero);
}

class KinematicChain {
 public:
  explicit KinematicChain(const Machine& machine);

  std::size_t joint_count() const { return joints_.size(); }
  Eigen::Vector3d nominal_point_w(const AxisPosition& position, const Eigen::Vector3d& tool_offset) const;
  /// Nominal rotation from tool to workpiece coordinates.
  Eigen::Matrix3d nominal_rotation_wt(const AxisPosition& position) const;
  /// One lever per joint, workpiece to tool; `levers` must have joint_count() entries. Returns the nominal
  /// point.
  Eigen::Vector3d levers(const AxisPosition& position, const Eigen::Vector3d& tool_offset,
                         JointLever* levers) const;
  /// levers() of readings side by side. `position`: by AxisName; `arm_s`: 3 per joint; `rotation_ws`: 9 per
  /// joint, row by row, null on a machine without rotary axes.
  void levers(const Lanes* position, const Eigen::Vector3d& tool_offset, Lanes* point_w, Lanes* arm_s,
              Lanes* rotation_ws) const;
  /// First-order pose error from given errors.
  ToolTwist first_order(const AxisPosition& position, const Eigen::Vector3d& tool_offset,
                        const PoseErrors<double>& errors) const;

  /// Exact pose of the tool in workpiece coordinates: rotation and functional point.
  template <class T>
  struct Pose {
    Eigen::Matrix<T, 3, 3> rotation_wt = Eigen::Matrix<T, 3, 3>::Identity();
    Eigen::Matrix<T, 3, 1> point_w = Eigen::Matrix<T, 3, 1>::Zero();
  };
  template <class T>
  Pose<T> exact_pose(const AxisPosition& position, const Eigen::Matrix<T, 3, 1>& tool_offset,
                     const PoseErrors<T>& errors) const;

  /// Displacement of the functional point per unit of one error: column of the first-order model.
  static Eigen::Vector3d motion_lever_w(const JointLever& lever, Component component);
  /// Rotation of the tool per unit of one error motion; zero for displacements.
  static Eigen::Vector3d motion_rotation_w(const JointLever& lever, Component component);
  /// Same for a location error of the lever's axis (squareness q e_k x e_axis, rotary location errors).
  static Eigen::Vector3d location_lever_w(const JointLever& lever, Component component);
  /// Rotation of the tool per unit of a location error; zero for squareness, which turns nothing.
  static Eigen::Vector3d location_rotation_w(const JointLever& lever, Component component);

 private:
  struct ChainJoint {
    AxisName axis;
    bool workpiece_side;
    Eigen::Vector3d reference_point;
    Eigen::Vector3d centre;
  };

  std::vector<ChainJoint> joints_;
};

template <class T>
KinematicChain::Pose<T> KinematicChain::exact_pose(const AxisPosition& position,
                                                   const Eigen::Matrix<T, 3, 1>& tool_offset,
                                                   const PoseErrors<T>& errors) const {
  using Vector = Eigen::Matrix<T, 3, 1>;
  using Matrix = Eigen::Matrix<T, 3, 3>;
  Pose<T> pose;
  pose.point_w = tool_offset;
  for (std::size_t i = joints_.size(); i-- > 0;) {
    const ChainJoint& joint = joints_[i];
    const auto& motion = errors.motion[index_of(joint.axis)];
    const auto& location = errors.location[index_of(joint.axis)];
    const T q(position[index_of(joint.axis)]);
    const Vector shift(motion[0], motion[1], motion[2]);
    const Matrix turn = rotation_321<T>(motion[3], motion[4], motion[5]);
    const int direction = direction_of(joint.axis);
    Vector& p = pose.point_w;
    if (!is_rotary(joint.axis)) {
      const Vector axis = Vector::Unit(direction);
      const Vector alpha(location[3], location[4], location[5]);
      const Vector travel = (axis + alpha.cross(axis)).normalized() * q;
      const Vector r = joint.reference_point.template cast<T>();
      if (joint.workpiece_side) p += travel;
      p = (turn * (p - r) + r + shift).eval();
      if (!joint.workpiece_side) p += travel;
      pose.rotation_wt = (turn * pose.rotation_wt).eval();
      continue;
    }
    Vector tilt(location[3], location[4], location[5]);
    const Matrix about_axis = rotation_about<T>(direction, q + tilt[direction]);
    tilt[direction] = T(0.0);
    const Matrix orientation = rotation_321<T>(tilt[0], tilt[1], tilt[2]);
    const Vector c = joint.centre.template cast<T>();
    const Vector c_actual = c + Vector(location[0], location[1], location[2]);
    if (joint.workpiece_side) {
      const Matrix stator = (turn * orientation.transpose()).eval();
      p = (about_axis * (stator * (p - c_actual) + shift) + c).eval();
      pose.rotation_wt = (about_axis * stator * pose.rotation_wt).eval();
    } else {
      p = (orientation * (turn * about_axis * (p - c) + shift) + c_actual).eval();
      pose.rotation_wt = (orientation * turn * about_axis * pose.rotation_wt).eval();
    }
  }
  return pose;
}

}  // namespace volcal
