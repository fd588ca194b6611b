#pragma once
/// Where errors in the volume of a machine are judged.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/errors/machine_effects.h"
#include "volcal/identify/errors/pose.h"
#include "volcal/model/description/machine.h"

namespace volcal {

/// Middle of the travel of every linear axis, rotary axes at 0: where the specific lines cross unless the
/// user says otherwise (ISO/TR 16907, 8.2.2).
AxisPosition middle_of_travel(const Machine& machine);
/// Every linear axis at its home, rotary axes at 0.
AxisPosition home_of(const Machine& machine);
/// 1 where the machine has the linear axis, 0 where it has not.
Eigen::Vector3d movable_directions(const Machine& machine);
/// Where the linear axes bring the functional point, m, but for a constant; a parallel axis goes on from its
/// home.
Eigen::Vector3d place_of(const Machine& machine, const AxisPosition& position);

/// Cells per linear axis where errors of a volume are judged, by budgets, tables and pages alike, unless the
/// user says otherwise.
inline constexpr int kVolumeCells = 9;

/// As many places as there are `cells` to the power of the number of axes, a hundred at least, spread evenly
/// over the travel of these linear axes; others at home. They follow a sequence without a period (Halton
/// 1960): no wave and no table has one in common with them, and as many positions of every axis are seen as
/// there are places.
std::vector<AxisPosition> spread_places(const Machine& machine, const std::vector<AxisName>& axes, int cells);
/// Both ends and the middle of the travel of these axes in all combinations, others at home.
std::vector<AxisPosition> ends_of_travel(const Machine& machine, const std::vector<AxisName>& axes);

struct VolumePoint {
  AxisPosition position{};
  ApproachDirection direction{};
  bool inside = true;  ///< counts in the mean; otherwise in the maximum alone
};
/// spread_places() of X, Y, Z and after them ends_of_travel(), each approached from + and - in all
/// combinations.
std::vector<VolumePoint> volume_points(const Machine& machine, int cells_per_axis);
struct VolumePose : VolumePoint {
  Eigen::Vector3d place_w;  ///< of the functional point, m; without turned axes but for a constant
};
/// The same of all linear axes, parallel ones too, for errors with these effects: axes whose direction makes
/// no difference to them are approached from -. Rotary axes `turned` take a position and directions of their
/// own at each of these places and all directions of approach, spread evenly over their travel; others stand
/// at 0.
std::vector<VolumePose> volume_poses(const Machine& machine, const Tool& tool, const MachineEffects& effects,
                                     const std::vector<AxisName>& turned, int cells_per_axis);
/// The middles of the cells, a lattice: for what is solved by positions of the axes.
std::vector<VolumePoint> volume_lattice(const Machine& machine, int cells_per_axis);

}  // namespace volcal
