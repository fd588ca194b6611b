#pragma once
/// What tools and spindle of a machine sweep with the rotary axes at home, and where its axes stand for a
/// point. m, workpiece coordinates.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "volcal/identify/planning/plan_settings.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

class SweptVolume {
 public:
  /// The settings must outlive the object.
  explicit SweptVolume(const PlanSettings& settings);

  /// Box of the functional points of all tools.
  const Eigen::AlignedBox3d& box_w() const { return box_w_; }
  /// Direction from the tool to the spindle.
  const Eigen::Vector3d& spindle_w() const { return spindle_w_; }
  /// Coordinate along the spindle, 0 to 2.
  int along_spindle() const;

  Eigen::Vector3d point_w(const AxisPosition& position, std::size_t tool) const;
  /// Where the linear axes stand, in whole micrometres, with the tool's functional point there; nullopt
  /// outside the travel.
  std::optional<AxisPosition> position_at(const Eigen::Vector3d& wanted_w, std::size_t tool) const;
  /// The same with the rotary axes where `rotary` has them: the linear axes follow (tool centre point
  /// control).
  std::optional<AxisPosition> position_at(const Eigen::Vector3d& wanted_w, std::size_t tool,
                                          const AxisPosition& rotary) const;
  /// Whether the straight line from a place to the tool's functional point keeps clear of the spindle: a
  /// cylinder about the tool axis, from its reference point away from the tool.
  bool passes_spindle(const Eigen::Vector3d& from_w, const AxisPosition& position, std::size_t tool) const;

 private:
  const PlanSettings& settings_;
  KinematicChain chain_;
  Eigen::AlignedBox3d box_w_;
  Eigen::Vector3d spindle_w_;
};

/// Shortest distance of the segment a-b from the half line that starts at `from` along `direction` (unit).
double distance_from_half_line(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                               const Eigen::Vector3d& from, const Eigen::Vector3d& direction);

/// In whole micrometres, as in an NC program.
double programmed_position(double q);

/// All axes at home.
AxisPosition home_position(const Machine& machine);

/// All axes at home, X, Y, Z at shares of their travel.
AxisPosition position_at_share(const Machine& machine, const Eigen::Vector3d& share);

}  // namespace volcal
