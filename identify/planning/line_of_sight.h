#pragma once
/// Whether an instrument at a station sees the reflector at the tool, and whether it can stand there.
///
/// Checked are the instrument's range and elevation, that the beam passes by the spindle (a cylinder about
/// the tool axis, from the spindle's reference point away from the tool), and that the station is outside the
/// box that tools and spindle sweep. Not checked: columns, covers, clamped workpieces, the reflector's own
/// angle of acceptance, the tool's shank.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "volcal/identify/planning/plan_settings.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

class LineOfSight {
 public:
  explicit LineOfSight(const PlanSettings& settings);

  /// Box of the functional points of all tools, workpiece coordinates, rotary axes at home.
  const Eigen::AlignedBox3d& swept_w() const { return swept_w_; }
  /// Where stations may be looked for.
  const Eigen::AlignedBox3d& stations_w() const { return stations_w_; }
  /// Direction from the tool to the spindle, workpiece coordinates, rotary axes at home.
  const Eigen::Vector3d& spindle_w() const { return spindle_w_; }

  bool can_stand(const Eigen::Vector3d& station_w) const;
  bool sees(const Eigen::Vector3d& station_w, const AxisPosition& position, std::size_t tool) const;
  Eigen::Vector3d point_w(const AxisPosition& position, std::size_t tool) const;

 private:
  const PlanSettings& settings_;
  KinematicChain chain_;
  Eigen::AlignedBox3d swept_w_;
  Eigen::AlignedBox3d kept_clear_w_;
  Eigen::AlignedBox3d stations_w_;
  Eigen::Vector3d spindle_w_;
};

/// Shortest distance of the segment a-b from the half line that starts at `from` along `direction` (unit).
double distance_from_half_line(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                               const Eigen::Vector3d& from, const Eigen::Vector3d& direction);

/// All axes at home, X, Y, Z at shares of their travel.
AxisPosition position_at_share(const Machine& machine, const Eigen::Vector3d& share);

}  // namespace volcal
