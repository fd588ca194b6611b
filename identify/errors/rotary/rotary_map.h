#pragma once
/// The error that rotary axes make, over their positions, of a tool that stays at one point of the
/// workpiece while the linear axes follow: as an R-test sees it, with the errors of the rotary axes alone.
/// Effects on their error motions are in it, mean of both directions of approach.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/errors/conditions.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/rotary/rotary_grid.h"

namespace volcal {

struct RotaryMapNode {
  PoseErrorVector value = PoseErrorVector::Zero();  ///< ex ey ez, m; ea eb ec, rad; workpiece coordinates
  PoseErrorVector u = PoseErrorVector::Zero();      ///< standard uncertainties
  double size = 0.0;                                ///< |(ex, ey, ez)|, m
  double u_size = 0.0;                              ///< of the component of (ex, ey, ez) in its own direction
  double tool_axis = 0.0;                           ///< error of the direction of the tool's axis, rad
  double u_tool_axis = 0.0;                         ///< of the component in its own direction
  bool extrapolated = false;                        ///< a rotary axis beyond its measured positions
};

struct RotaryMap {
  std::string tool;
  Eigen::Vector3d point_w = Eigen::Vector3d::Zero();  ///< workpiece coordinates, m
  std::vector<RotaryNodes> axes;                      ///< one or two, A B C
  std::vector<RotaryMapNode> nodes;                   ///< the last axis fastest
  std::vector<AxisPosition> poses;                    ///< of all axes, at the nodes
};

/// Where the nominal tool point stands with the linear axes in the middle of their travel, rotary axes at 0.
Eigen::Vector3d middle_point_w(const Machine& machine, const Tool& tool);

/// Rotary axes at 0, or at the end of their travel that is nearest to it.
AxisPosition rotary_axes_at_rest(const Machine& machine);

/// X, Y, Z where they bring the nominal tool point to a place of the workpiece, by least squares, rotary axes
/// as in `rotary`; U, V, W stand at home.
AxisPosition followed_pose(const Machine& machine, const Tool& tool, const Eigen::Vector3d& point_w,
                           AxisPosition rotary);

/// Over the first two identified rotary axes, at positions `largest_step` rad apart at most; others stand at
/// 0, or at the end of their travel that is nearest to it. A linear axis may leave its travel: nothing of the
/// linear axes but the lever depends on where they stand. Throws InputError where no rotary axis was
/// identified.
RotaryMap rotary_map(const FitResult& result, const Tool& tool, const Eigen::Vector3d& point_w,
                     const Conditions& conditions, double largest_step);

}  // namespace volcal
