#pragma once
/// The search for stations, runs and positions.
///
/// Stations: the best of a coarse lattice, added one after another, then exchanged one by one (Fedorov
/// 1972, 3.3), and as a second start the textbook's corners; both refined by pattern search (Hooke and Jeeves
/// 1961, J. ACM 8, 212) until steps are below 10 mm. Positions: exchange_design.h over a jittered grid for
/// every run; of instruments whose runs are taken whole, path_choice.h over every tool at every station. The
/// two take turns until neither helps. Where time is limited, runs that it does not carry and those that cost
/// more of it than they are worth are left out.
///
/// That the arrangement of stations decides what multilateration can know, and that some arrangements know
/// nothing: Takatsuji, Koseki, Goto et al. 1998, Meas. Sci. Technol. 9, 1357; Takatsuji, Goto, Kirita et al.
/// 2000, Meas. Sci. Technol. 11, 477.

#include <string>
#include <vector>

#include "volcal/identify/planning/line_of_sight.h"
#include "volcal/identify/planning/plan_layout.h"
#include "volcal/identify/planning/plan_problem.h"

namespace volcal {

/// What everybody would do. Trackers: stations at the corners of the volume's floor (with another number:
/// evenly around it), every fourth raised to the top of the region, every tool at each, an even grid for each
/// run. Ball-bars: places along the middle of the volume, circles in three planes with every tool, place and
/// tool in turn as far as the budget goes. Throws InputError where nothing can be measured whole, where no
/// station sees anything, and where the budget does not hold one run at every station.
PlanLayout textbook_layout(const PlanSettings& settings, const LineOfSight& sight);

/// Throws InputError: from no place enough can be measured.
[[noreturn]] void fail_unseen(const LineOfSight& sight);
/// Throws InputError: the budget does not hold one run at every station.
[[noreturn]] void fail_one_run_at_every_station();

struct SearchedPlan {
  PlanLayout layout;
  std::vector<std::size_t> tools;  ///< that were chosen to be used
  double value = 0.0;              ///< of the criterion
  double textbook = 0.0;           ///< the same of the textbook's layout
  bool converged = false;          ///< of the positions: no exchange helps
  std::size_t pool = 0;            ///< positions that could have been taken
  /// Per station: how far it may be off, along any axis, until the criterion is 1 % worse; m.
  std::vector<double> station_tolerance;
  /// Stations found from another start that are as good within 1 %; empty = none.
  std::vector<Eigen::Vector3d> as_good_w;
  double as_good_ratio = 1.0;  ///< of the target's standard uncertainty there to here
};

SearchedPlan search_plan(const PlanSettings& settings, const PlanProblem& problem, const LineOfSight& sight);

/// Readings that fit into the time with these runs; the budget's readings without a time.
std::size_t affordable_readings(const PlanSettings& settings, const PlanLayout& layout);
bool carries_a_position_of_each(const PlanSettings& settings, const PlanLayout& layout);

}  // namespace volcal
