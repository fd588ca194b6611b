#pragma once
/// Commanded positions of the usual measuring paths. m; axis positions, not workpiece coordinates. Axes that
/// do not move stand where the start says and count as approached in the + direction.

#include <Eigen/Core>
#include <vector>

#include "volcal/model/description/machine.h"
#include "volcal/sim/machine/random.h"
#include "volcal/sim/measurement/setup_plan.h"

namespace volcal::sim {

/// What rotary axes do while linear axes go their way.
enum class RotaryMotion {
  Home,    ///< stand at home
  Random,  ///< uniformly distributed over their range at every position
  Grid     ///< one node of a grid of rotary positions after another
};

/// Position of all axes with X, Y, Z at `fraction` of their travel, U, V, W and rotary axes at home.
CommandedPoint at_fraction(const Machine& machine, const Eigen::Vector3d& fraction);

/// `count` equally spaced points from start to end, `runs` times forward and, if bidirectional, back; each
/// pass is a line (numbered from 0) approached from one side with overrun. count >= 2.
std::vector<CommandedPoint> straight_path(const CommandedPoint& start, const CommandedPoint& end, int count,
                                          int runs, bool bidirectional);

/// Sequential step diagonal (ISO 230-6): from start to end in `steps` steps, each moving X, then Y, then Z.
std::vector<CommandedPoint> step_path(const CommandedPoint& start, const CommandedPoint& end, int steps,
                                      int runs, bool bidirectional);

/// Full circle of two linear axes about `centre`: line and run 0 clockwise, 1 counter-clockwise as seen along
/// the negative normal (first axis towards second is counter-clockwise), both from angle 0 with overlap.
std::vector<CommandedPoint> circular_path(const CommandedPoint& centre, AxisName first, AxisName second,
                                          double radius, int points_per_turn);

/// Positions of a grid along X, Y, Z; one along an axis that the machine lacks.
Eigen::Vector3i counts_of_axes(const Machine& machine, Eigen::Vector3i counts);

/// Boustrophedon grid over the whole travel, each position moved by up to `jitter` of a grid step and clipped
/// to the travel, in whole micrometres, then the same positions in reverse order approached from the other
/// side. Each row is a line.
std::vector<CommandedPoint> jittered_grid_path(const Machine& machine, const Eigen::Vector3i& per_axis,
                                               double jitter, RandomStream& random);

/// Positions on the way from each point of a line to the next, at random shares of it; for the last point of
/// a line, on the way to it. As many as `points`, with their lines, runs and speeds.
std::vector<CommandedPoint> points_between(const std::vector<CommandedPoint>& points, RandomStream& random);

/// Puts whole lines of a setup into random order, the unseen positions along with them. Each point keeps its
/// direction of approach: the machine overruns it from the same side.
void shuffle_lines(RandomStream& random, SetupPlan& plan);

/// Uniformly distributed over the travel of X, Y, Z, in whole micrometres; rotary axes at home or
/// uniformly distributed too, U, V, W at home, direction not recorded. `rotary`: Home or Random.
std::vector<CommandedPoint> random_points(const Machine& machine, int count, RandomStream& random,
                                          RotaryMotion rotary = RotaryMotion::Home);

/// U, V, W of points that stand for X, Y, Z: uniformly distributed over their travel, in whole micrometres.
/// `there_and_back`: the second half of the points are the first in reverse order from the other side.
void add_parallel_motion(const Machine& machine, bool there_and_back, RandomStream& random,
                         std::vector<CommandedPoint>& points);

/// Direction of approach of `to` after the move from `from`; where an axis rests, the last one stays.
void approach(const CommandedPoint& from, CommandedPoint& to);

}  // namespace volcal::sim
