#pragma once
/// The ideal compensation of rotary axes' errors and of the tool's orientation (ISO/TR 16907:2015, 8.2.6 and
/// 8.2.8 to 8.2.14), as corrections of the commands of all axes at a pose.
///
/// With e + eps the error motions of a rotary axis at its position, dp and alpha its location errors, s = +1
/// on the tool side and -1 on the workpiece side, x the nominal functional point from the axis' centre in the
/// stator frame (chain.h), and tilt = eps, alpha without the rotation about the axis itself, a type corrects
///   R-POS  the axis' own rotation eps_own + alpha_own, by the command of the axis
///   R-RAX  e + tilt x ref      R-ANG  tilt x (x - ref)      R-POR  s (dp + alpha_tilt x x)
/// and the linear axes get dx = -J^-1 delta, J their directions and delta the sum of these displacements in
/// workpiece coordinates. Directions that they hardly move (singular values of J below a twentieth) are left.
/// R-VOL, the sum of all, depends on no reference. A parallel axis U, V, W is at its position in all levers
/// and its errors are among those of L-VOL; X, Y, Z move, as far as there is a direction that they move.
/// L-VOL is here with the rotary axes where they stand, zero at home approached towards +, but with R-POR
/// where a table turns the workpiece: the error at home does not turn with it. The parts L-POS to L-ANG are
/// those of compensation.h.
///
/// FOR turns two rotary axes so that the tool's axis, z of the tool, has its nominal direction in the
/// workpiece. Errors of all axes count (8.2.6, note). Near a pole one rotary axis hardly turns it; the moves
/// minimise |direction error|^2 + damping^2 |moves|^2, so that none is larger than the error / (2 damping):
/// at the default damping 0.01 that is 50 times the error, and where the axes are 6 degrees or more from the
/// pole 1 % of the error is left. With L-ANG or R-ANG beside it the linear axes undo what these moves do to
/// the functional point (Newton's iteration on the exact model); FOR alone leaves that (8.2.6).

#include "volcal/identify/compensation/compensation_type.h"
#include "volcal/identify/compensation/correction.h"
#include "volcal/identify/errors/error_field.h"

namespace volcal {

inline constexpr double kOrientationDamping = 0.01;

/// Where the displacement of R-RAX is stated.
struct RotaryReference {
  /// Of axes A, B, C on the workpiece side: a point of the axis at this distance from its centre, m.
  std::array<double, 3> elevation{};
  /// Of axes on the tool side: the functional point of a tool of this offset, m; that of the compensation
  /// otherwise.
  std::optional<Eigen::Vector3d> tool_offset;
};

struct FiveAxisSettings {
  CompensationType type = CompensationType::rotary_volumetric();
  Eigen::Vector3d tool_offset = Eigen::Vector3d::Zero();  ///< as the control knows it, m
  RotaryReference reference;
  double damping = kOrientationDamping;
  /// False: a control that turns no axis. The linear axes undo what R-POS corrects, too: the functional point
  /// is the same, the orientation stays.
  bool turns_axes = true;
};

/// Errors of every axis at a pose.
using JointErrorSource = std::function<PoseErrors<double>(const AxisPosition&, const ApproachDirection&)>;

class FiveAxisCompensation {
 public:
  /// Throws InputError for FOR on a machine without three linear axes and two rotary ones that turn the
  /// tool's axis.
  FiveAxisCompensation(const Machine& machine, const FiveAxisSettings& settings, JointErrorSource errors);

  Correction correction(const AxisPosition& position, const ApproachDirection& direction = {}) const;
  /// First-order displacement of the functional point that the type corrects by the linear axes, R-POS and
  /// FOR left out; workpiece coordinates, m.
  Eigen::Vector3d displacement_w(const AxisPosition& position, const ApproachDirection& direction = {}) const;
  /// Error of the compensated machine whose errors are these: exact model; m, and the angle between the
  /// tool's axis and its nominal direction, rad.
  struct Left {
    Eigen::Vector3d displacement_w = Eigen::Vector3d::Zero();
    double axis = 0.0;
    Eigen::Vector3d axis_w = Eigen::Vector3d::UnitZ();  ///< direction of the tool's axis
  };
  Eigen::Vector3d nominal_point_w(const AxisPosition& position) const {
    return chain_.nominal_point_w(position, settings_.tool_offset);
  }
  /// Direction of the tool's axis without errors.
  Eigen::Vector3d nominal_axis_w(const AxisPosition& position) const;
  Left left_by(const Correction& correction, const AxisPosition& position,
               const ApproachDirection& direction = {}) const;

 private:
  struct Levers;
  struct Shares;

  Levers levers_at(const AxisPosition& position) const;
  Eigen::Vector3d reference_arm(const JointLever& lever, const Levers& at) const;
  void add_rotary(const JointLever& lever, const Levers& at, const PoseErrors<double>& errors,
                  Shares& shares) const;
  Shares shares_at(const AxisPosition& position, const ApproachDirection& direction, const Levers& at) const;
  KinematicChain::Pose<double> exact_pose(const AxisPosition& programmed, const Correction& correction,
                                          const ApproachDirection& direction) const;
  Eigen::Vector3d orientation_moves(const Levers& at, const AxisPosition& position,
                                    const ApproachDirection& direction, const Correction& others) const;
  Eigen::Vector3d exact_linear_moves(const Levers& at, const Shares& shares, const AxisPosition& position,
                                     const ApproachDirection& direction, const Correction& start) const;
  void require_turning_axes(const Machine& machine) const;

  KinematicChain chain_;
  FiveAxisSettings settings_;
  JointErrorSource errors_;
  std::array<Eigen::Vector3d, 3> centre_;                 ///< of A, B, C
  Eigen::Vector3d home_moves_ = Eigen::Vector3d::Zero();  ///< of L-VOL at home, m
};

/// Of the rotary axes that turn the workpiece, the one nearest to the bed.
std::optional<AxisName> outermost_table_axis(const Structure& structure);

/// Directions of X, Y, Z in workpiece coordinates, zero where the machine lacks the axis.
Eigen::Matrix3d linear_directions(const JointLever* levers, std::size_t count);
/// Moves of X, Y, Z along these directions that displace the functional point; directions that they hardly
/// move are left.
Eigen::Vector3d linear_moves(const Eigen::Matrix3d& directions_w, const Eigen::Vector3d& displacement_w);

/// Errors as identified, at stated conditions.
JointErrorSource joint_errors(const FitResult& result, const Tool& tool, const Conditions& conditions);

/// The same and what effects displace the tool's offset by. Where a table turns the workpiece that is the
/// same as a displacement of its outermost axis; without one it is left out.
JointErrorSource joint_and_tool_errors(const FitResult& result, const Tool& tool,
                                       const Conditions& conditions);

}  // namespace volcal
