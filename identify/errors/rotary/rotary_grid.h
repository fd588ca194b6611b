#pragma once
/// Spatial error grid of rotary axes (ISO/TR 16907:2015, 9.3.2, Table 3): at every combination of their
/// positions the rigid error twist of the body that they turn.
///
/// The rotary axes on the workpiece side turn the table, those on the tool side the tool; each side has a
/// grid of its own. Its coordinates are those of the body that carries these axes, parallel to the machine's,
/// in which the reference point is fixed. With x the nominal functional point there, the axes' errors
/// displace the tool relative to the workpiece by t + phi x (x - reference), first order, whatever the tool.

#include <Eigen/Core>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/errors/conditions.h"
#include "volcal/identify/errors/error_field.h"

namespace volcal {

enum class TurnedBody { Table, Tool };
std::string_view to_string(TurnedBody body);

/// Largest step of positions unless the user says otherwise, rad: at 10 degrees bilinear interpolation of
/// functions of up to two waves a turn is off by 0.1 um RMS at 200 mm.
inline constexpr double kDefaultRotaryGridStep = 10.0 * 3.14159265358979323846 / 180.0;

/// Positions of one rotary axis.
struct RotaryNodes {
  AxisName axis = AxisName::C;
  std::vector<double> positions;  ///< ascending, equal steps, rad
  /// The last position is one turn beyond the first and has its errors: positions count modulo a turn.
  /// Otherwise the end values hold beyond the ends.
  bool full_turn = false;
};

/// At most `largest_step` apart, both ends of the travel included. Of an axis that travels a turn or more and
/// whose identified errors repeat after a turn, one turn.
RotaryNodes rotary_nodes(const FitResult& result, AxisName axis, double largest_step);

struct RotaryTwist {
  PoseErrorVector value = PoseErrorVector::Zero();  ///< t, m, at the reference point; phi, rad
  PoseErrorVector u = PoseErrorVector::Zero();      ///< standard uncertainties
  bool extrapolated = false;                        ///< beyond the measured positions
};

struct RotaryGrid {
  TurnedBody body = TurnedBody::Table;
  /// Centre of the axis nearest to the workpiece or to the tool; machine coordinates, all axes at 0, m.
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();
  std::vector<RotaryNodes> axes;    ///< A or B first, C last
  std::vector<RotaryTwist> twists;  ///< the last axis fastest

  /// Position of every node, other axes at 0.
  std::vector<AxisPosition> positions() const;
};

/// Which errors of rotary axes count.
struct RotaryShares {
  bool own = true;       ///< rotations about the axes themselves
  bool location = true;  ///< displacement and tilt of the axis lines
  bool motion = true;    ///< displacement and tilt error motions
};

/// Why there is no grid: a linear axis stands between rotary axes of one side, and its position counts too.
/// Empty where there is one.
std::string no_rotary_grid(const FitResult& result);

/// One grid for every side of the bed that has identified rotary axes, mean of both directions of approach.
/// Throws InputError where there is none.
std::vector<RotaryGrid> rotary_grids(const FitResult& result, const Conditions& conditions,
                                     double largest_step, const RotaryShares& shares = {});

}  // namespace volcal
