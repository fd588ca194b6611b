#pragma once
/// Where rotary axes are measured: grids of every combination of their positions, which alone tell the axes
/// apart (one axis after another leaves most location errors invisible), and the poses over which the error
/// of a machine with rotary axes is judged.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "volcal/identify/planning/plan_layout.h"
#include "volcal/identify/planning/swept_volume.h"

namespace volcal {

/// Stretch of a rotary axis that grids cover: its travel, of more than a turn the turn about its home.
struct RotaryStretch {
  AxisName axis = AxisName::C;
  double min = 0.0;  ///< rad
  double max = 0.0;
  bool whole_turn = false;  ///< the end is the start

  double length() const { return max - min; }
  /// Node `i` of `count`, ends included unless they are one position.
  double node(double i, int count) const;
};

/// Of every rotary axis, the longest first.
std::vector<RotaryStretch> rotary_stretches(const Machine& machine);

/// Refuses a machine without rotary axes, or with more than a grid can have; `instrument`: what is planned.
void require_rotary_axes(const Machine& machine, const std::string& instrument);

/// The rotary axis that carries the workpiece, if one does.
const Axis* innermost_table(const Machine& machine);

/// Where workpieces stand that rotary axes turn, m: about the axis of the innermost rotary table, a quarter
/// of the smallest side of the swept box to either side and as high above its centre; of a machine whose tool
/// alone turns the half of the swept box away from the spindle.
Eigen::AlignedBox3d rotary_region_w(const Machine& machine, const SweptVolume& swept);

/// `count` places on a circle about the middle of a region, at one height, in whole millimetres.
std::vector<Eigen::Vector3d> places_on_circle_w(const Eigen::AlignedBox3d& region_w, int along_spindle,
                                                int count);

/// One axis goes through its stretch in `count` positions, in whole tenths of a degree, all others at home.
std::vector<PlanPosition> rotary_sweep(const Machine& machine, const RotaryStretch& stretch, int count);

/// About `positions` of them in a grid over all rotary axes, counts in proportion to the stretches, 3 at
/// least; each moved by up to `jitter` of a step, others for every `stream`, in whole tenths of a degree. The
/// linear axes stand at home. Cells: the longest axis changes fastest.
std::vector<PlanPosition> rotary_grid(const Machine& machine, std::size_t positions, double jitter,
                                      std::uint64_t seed, std::uint64_t stream);

/// Poses of a tool at corners and middle of a box of the workpiece, `per_axis` positions of every rotary
/// axis, those that the linear axes reach.
std::vector<AxisPosition> poses_in_box(const Machine& machine, const SweptVolume& swept,
                                       const Eigen::AlignedBox3d& box_w, std::size_t tool, int per_axis);

}  // namespace volcal
