#pragma once
/// Tool centre point motion on an identified machine: programs say where the functional point is in the
/// workpiece and where the rotary axes stand, and the control moves X, Y, Z by the nominal kinematics.
///
/// Points are in workpiece coordinates, m: those of the table with all rotary axes at 0, in which the machine
/// has its coordinates (chain.h). Rotary positions of A, B, C are in rad; those of an axis that travels a
/// turn count modulo it.

#include <Eigen/Core>
#include <functional>
#include <map>
#include <string>

#include "volcal/identify/compensation/five_axis_compensation.h"

namespace volcal {

/// What a block of such a program says.
struct TcpPose {
  Eigen::Vector3d point_w = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotary = Eigen::Vector3d::Zero();

  /// t = 0..1; the control moves all of them in proportion.
  static TcpPose between(const TcpPose& from, const TcpPose& to, double t);
};

/// At which turns count as displacements, m.
inline constexpr double kTcpLever = 0.1;

/// Places of a motion at which it is looked at: about a millimetre or a quarter of a degree apart.
double tcp_places(const TcpPose& from, const TcpPose& to);

class TcpMachine {
 public:
  /// `orientation`: rotary axes turn the tool's axis to where it is meant, too (FOR). Throws InputError where
  /// the machine cannot.
  TcpMachine(const Machine& machine, const Eigen::Vector3d& tool_offset, JointErrorSource errors,
             bool orientation);

  /// Where the control sends the axes. Throws std::runtime_error where X, Y, Z do not reach the point.
  AxisPosition axes_at(const TcpPose& pose) const;
  /// The same place with rotary positions within the travel of axes that travel a turn.
  AxisPosition counted(const AxisPosition& position) const;
  /// What to program so that the functional point is at the pose's: to 1 nm by the exact model. The rotary
  /// axes take back their own rotation, and with `orientation` what FOR adds, which is bounded at a pole
  /// (five_axis_compensation.h).
  TcpPose command(const TcpPose& pose, const ApproachDirection& direction) const;
  /// In which the axes move at place t of a motion, by the nominal way of each; one that stands keeps its
  /// direction of `held`.
  ApproachDirection directions(const TcpPose& from, const TcpPose& to, double t,
                               const ApproachDirection& held) const;
  /// Of the machine that is sent to `sent`, against what is `meant`.
  struct Left {
    double point = 0.0;  ///< m
    double axis = 0.0;   ///< of the tool's axis, rad
  };
  Left left(const TcpPose& sent, const TcpPose& meant, const ApproachDirection& direction) const;

 private:
  AxisPosition with_linear(const Eigen::Vector3d& linear, const Eigen::Vector3d& rotary) const;
  KinematicChain::Pose<double> actual(const AxisPosition& commanded,
                                      const ApproachDirection& direction) const;
  Eigen::Matrix3d directions_at(const AxisPosition& position) const;

  Machine machine_;
  KinematicChain chain_;
  Eigen::Vector3d tool_;
  JointErrorSource errors_;
  FiveAxisCompensation compensation_;
};

/// Errors of every axis with a tool of that offset, m.
using ErrorsOfOffset = std::function<JointErrorSource(const Eigen::Vector3d& offset)>;

/// One for every tool that a program uses.
class TcpMachines {
 public:
  /// As TcpMachine.
  TcpMachines(const Machine& machine, ErrorsOfOffset errors, bool orientation);
  /// Stays valid.
  const TcpMachine& with(const Eigen::Vector3d& tool_offset);

 private:
  Machine machine_;
  ErrorsOfOffset errors_;
  bool orientation_;
  std::map<std::string, TcpMachine> machines_;  ///< by tool offset
};

}  // namespace volcal
