#include <Eigen/LU>
#include <cmath>

#include "volcal/sim/machine/control_kinematics.h"

namespace volcal::sim {
namespace {

/// Joints = turned * point + constant, as the lines of trtfuncs.c have it.
struct TrtJoints {
  Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
  Eigen::Vector3d constant = Eigen::Vector3d::Zero();
};

/// `tilt`, `c`: of the module's pins, which turn the table with their sign.
TrtJoints trt_joints(const ControlPivots& pivots, double tool, double tilt, double c) {
  const double ct = std::cos(tilt), st = std::sin(tilt), cc = std::cos(c), sc = std::sin(c);
  const double d = pivots.across_offset, dz = pivots.z_offset + tool;
  TrtJoints joints;
  if (pivots.tilt == AxisName::A) {
    joints.turned << cc, -sc, 0.0, sc * ct, cc * ct, -st, sc * st, cc * st, ct;
    joints.constant = {0.0, d - ct * d + st * dz, dz - st * d - ct * dz};
  } else {
    joints.turned << cc * ct, -sc * ct, st, sc, cc, 0.0, -cc * st, sc * st, ct;
    joints.constant = {d - ct * d - st * dz, 0.0, dz + st * d - ct * dz};
  }
  joints.constant += pivots.rot_point - joints.turned * pivots.rot_point;
  return joints;
}

}  // namespace

CommandCorrection pivot_correction(const ControlPivotChange& change) {
  return [change](const MachineState& state) {
    const double tilt = -state.position[index_of(change.drawn.tilt)];  // ISO 841: the tool turns
    const double c = -state.position[index_of(AxisName::C)];
    const TrtJoints drawn = trt_joints(change.drawn, change.tool_length, tilt, c);
    const TrtJoints loaded = trt_joints(change.loaded, change.tool_length, tilt, c);
    const Eigen::Vector3d commanded(state.position[0], state.position[1], state.position[2]);
    const Eigen::Vector3d point = drawn.turned.inverse() * (commanded - drawn.constant) + change.work_moved;
    return CommandMoves(loaded.turned * point + loaded.constant - commanded);
  };
}

}  // namespace volcal::sim
