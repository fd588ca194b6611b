#pragma once
/// What the planners of several measurements share.

#include <functional>
#include <string>
#include <vector>

#include "volcal/model/description/machine.h"
#include "volcal/sim/machine/random.h"
#include "volcal/sim/measurement/measurements.h"
#include "volcal/sim/measurement/setup_plan.h"

namespace volcal::sim {

/// Machine and naming of one measurement while its setups are planned.
struct PlanContext {
  const Machine& machine;
  std::string prefix;  ///< of setup names, with its underscore
  std::uint64_t seed;
  SourcePlace place;

  /// Index of a tool by name, the first when the name is empty; throws InputError.
  std::size_t tool(const std::string& name) const;
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const;
  /// X, Y, Z, of which the machine has them.
  std::vector<AxisName> linear_axes() const;
  /// Throws InputError for an axis that the machine lacks.
  void require_axis(AxisName axis) const;
  /// The planes named; where none is, XY, YZ, ZX, of which the machine has both axes.
  std::vector<std::string> planes_of(const std::vector<std::string>& named) const;
  /// Throws InputError unless value >= least.
  void require_at_least(int value, int least, const std::string& what) const;
};

/// Two linear axes named as in "XY"; the remaining one is the normal.
struct Plane {
  AxisName first;
  AxisName second;
};
Plane parse_plane(const std::string& name, const PlanContext& context);

/// Start and end of an axis' travel, of a rotary one a turn at most, with X, Y, Z at shares `at` of theirs.
struct LineEnds {
  CommandedPoint start;
  CommandedPoint end;
};
LineEnds axis_line(const Machine& machine, AxisName axis, const Eigen::Vector3d& at);

/// A position as a user would state it, in whole steps of `millimetres`.
Eigen::Vector3d stated_position(const Eigen::Vector3d& position, double millimetres);

/// Place of the tool point at rotary positions, workpiece coordinates; it may set the point's normal.
using PoseTarget = std::function<Eigen::Vector3d(CommandedPoint& rotary)>;
/// Fills points and unseen points of a setup: the grid's rotary positions, linear axes following; what lies
/// beyond their travel is left out and counted. Throws InputError where too few are left.
void follow_poses(const RotaryGrid& grid, const PoseTarget& target, const PlanContext& context,
                  SetupPlan& plan);

/// The tools named, the machine's first three where none is; throws InputError.
std::vector<std::size_t> tools_of(const RotaryPoses& poses, const PlanContext& context);
/// Throws InputError for poses that make no sense on the machine.
void check_poses(const RotaryPoses& poses, const PlanContext& context);
/// Throws InputError where rotary axes shall move and there are none.
void require_rotary_axes(const PlanContext& context);
/// "workpiece", "tool" or "machine"; throws InputError.
void check_frame(const std::string& frame, const PlanContext& context);

std::vector<SetupPlan> plan_tracking(const Tracking& settings, const PlanContext& context);
std::vector<SetupPlan> plan_ball_bar(const BallBarCircles& settings, const PlanContext& context);
std::vector<SetupPlan> plan_diagonals(const Diagonals& settings, const PlanContext& context);
std::vector<SetupPlan> plan_axis_lines(const AxisLines& settings, const PlanContext& context);
std::vector<SetupPlan> plan_straightness(const StraightnessLines& settings, const PlanContext& context);
std::vector<SetupPlan> plan_squares(const Squares& settings, const PlanContext& context);
std::vector<SetupPlan> plan_angles(const AngleLines& settings, const PlanContext& context);
std::vector<SetupPlan> plan_point_grid(const PointGrid& settings, const PlanContext& context);
std::vector<SetupPlan> plan_r_test(const RTest& settings, const PlanContext& context);
std::vector<SetupPlan> plan_probed_sphere(const ProbedSphere& settings, const PlanContext& context);
std::vector<SetupPlan> plan_ball_bar_poses(const BallBarPoses& settings, const PlanContext& context);
std::vector<SetupPlan> plan_axis_of_rotation(const AxisOfRotation& settings, const PlanContext& context);
std::vector<SetupPlan> plan_drift_at_rest(const DriftAtRest& settings, const PlanContext& context);

}  // namespace volcal::sim
