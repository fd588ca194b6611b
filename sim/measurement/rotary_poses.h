#pragma once
/// Positions of rotary axes in a campaign, and the linear axes that follow them so that the tool point stays
/// where it shall (tool centre point control). m and rad; workpiece coordinates `w`.

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "volcal/sim/machine/random.h"
#include "volcal/sim/machine/truth_machine.h"
#include "volcal/sim/measurement/paths.h"
#include "volcal/sim/measurement/setup_plan.h"

namespace volcal::sim {

/// Which rotary positions are met.
struct RotaryGrid {
  std::map<AxisName, int> points;  ///< absent: 12 of an axis that turns right round, otherwise 7
  std::map<AxisName, std::array<double, 2>> range;  ///< absent: the travel, one turn about home at most
  /// Every position of one axis with every position of the others; otherwise one axis after another, the
  /// others at home, which leaves most location errors invisible.
  bool combined = true;
  bool bidirectional = false;  ///< back through the same positions from the other side
  double jitter = 0.0;         ///< largest departure, as a share of a step
};

/// From-to of an axis within the grid's range; of a whole turn the end is the start and left out of grids.
std::array<double, 2> rotary_range(const RotaryGrid& grid, const Axis& axis);
bool is_whole_turn(const std::array<double, 2>& range);

/// Positions of the rotary axes of `machine` in the order of measurement, linear axes at 0; the axis with
/// most positions moves fastest, there and back. Each sweep of it is a line. Directions of approach are not
/// set.
std::vector<CommandedPoint> rotary_path(const Machine& machine, const RotaryGrid& grid, RandomStream& random);

/// Nominal axes, by columns, of "workpiece", "tool" or "machine" in workpiece coordinates. Throws
/// std::invalid_argument for another word.
Eigen::Matrix3d axes_of_frame(const TruthMachine& machine, const MachineState& state,
                              const std::string& frame);

/// Nominal direction of a rotary axis, workpiece coordinates, the other axes as in `point`: that in which the
/// tool turns against the workpiece for a positive command.
Eigen::Vector3d rotary_direction_w(const TruthMachine& nominal, const CommandedPoint& point, AxisName axis);

/// Linear axes follow: which positions bring the nominal tool point to a place. Of a machine without X, Y or
/// Z those that it has, as far as they lead there.
class Follower {
 public:
  Follower(const TruthMachine& nominal, Eigen::Vector3d tool_offset);

  struct Pose {
    CommandedPoint point;
    std::string outside;  ///< letters of linear axes beyond their travel, "X"; all where none lead there
    bool leads_there = true;
  };
  /// `rotary`: rotary positions, line and run are kept; directions are not set.
  Pose at(const CommandedPoint& rotary, const Eigen::Vector3d& target_w) const;
  /// The linear axes as near to `target_w` as they lead; travel is not looked at.
  CommandedPoint nearest(const CommandedPoint& rotary, const Eigen::Vector3d& target_w) const;
  /// The axes of a pose moved so that its nominal tool point moves by `shift_w`; travel is not looked at.
  CommandedPoint moved(const CommandedPoint& pose, const Eigen::Vector3d& shift_w) const;

 private:
  Eigen::Matrix3Xd directions(const CommandedPoint& rotary) const;

  const TruthMachine& nominal_;
  Eigen::Vector3d tool_offset_;
  std::vector<AxisName> axes_;  ///< X, Y, Z, of which the machine has them
};

/// Rotary positions of points that have linear ones. `Grid`: the nodes of `grid` one after another.
/// `there_and_back`: the second half of the points are the first in reverse order from the other side.
void add_rotary_motion(const Machine& machine, RotaryMotion motion, const RotaryGrid& grid,
                       bool there_and_back, RandomStream& random, std::vector<CommandedPoint>& points);

}  // namespace volcal::sim
