#pragma once
/// What no reading of tool against workpiece can tell of the locations of axes, whatever the poses: of errors
/// that all poses exchange, one stands for all.

#include <Eigen/Core>
#include <vector>

#include "volcal/model/description/machine.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

/// Element `index` of the van der Corput sequence of a base, in [0, 1): digits mirrored behind the point.
double radical_inverse(int index, int base);
/// Poses spread over the travel of every axis, of a rotary axis over a turn at most, the same at every call
/// (Halton 1960).
std::vector<AxisPosition> spread_poses(const Machine& machine, int count);

/// Displacements of the functional point that are no error of an axis: of the workpiece (shift, rotation),
/// and of a tool whose offset is uncertain. 3 rows, workpiece coordinates.
Eigen::Matrix<double, 3, Eigen::Dynamic> frame_columns(const Machine& machine, const KinematicChain& chain,
                                                       const AxisPosition& position, std::size_t tool);

/// A pose with a functional point of its own.
struct PosedPoint {
  AxisPosition position{};
  Eigen::Vector3d offset_t = Eigen::Vector3d::Zero();  ///< m, from the spindle's reference point
};
/// spread_poses() with offsets along the spindle and to either side of it, which tell every rotation.
std::vector<PosedPoint> spread_points(const Machine& machine, int count);

/// Displacements of functional points by what a change of the machine's coordinate system moves, three rows a
/// point, workpiece coordinates.
struct FrameChangeColumns {
  Eigen::MatrixXd locations;  ///< a column for each
  Eigen::MatrixXd workpiece;  ///< shift, m; rotation, rad
  Eigen::MatrixXd tools;      ///< rotation of the tools' common frame, rad
};
FrameChangeColumns frame_change_columns(const Machine& machine, const std::vector<LocationSymbol>& locations,
                                        const std::vector<PosedPoint>& points);

/// Location errors of which none is a combination of the others, the place of the workpiece and, where the
/// machine states an uncertainty, the offsets of its tools: squareness, then of the rotary axes from the bed
/// outwards the tilts of the axis line, its displacements and the zero position. An error that follows from
/// earlier ones is left out: it is zero by convention, as EC0C of a table, which the workpiece's place holds.
std::vector<LocationSymbol> independent_locations(const Machine& machine);

}  // namespace volcal
