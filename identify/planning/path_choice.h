#pragma once
/// Which of the runs that are taken whole or not at all a plan takes, where not all fit into its readings and
/// its time.
///
/// Of all runs the one whose loss costs the criterion least is left out, again and again until the rest fits;
/// then runs inside are exchanged for promising ones outside as long as that helps (Fedorov 1972, Theory of
/// Optimal Experiments, 3.3).

#include "volcal/identify/planning/plan_layout.h"
#include "volcal/identify/planning/plan_problem.h"

namespace volcal {

struct ChosenPaths {
  PlanLayout layout;
  bool converged = false;  ///< no exchange of the most promising pairs helps
};

/// Every station of `all` keeps one run at least. Throws InputError where even those do not fit.
ChosenPaths choose_paths(const PlanSettings& settings, const PlanProblem& problem, const PlanLayout& all,
                         int threads);

/// Whether readings and time suffice for a layout.
bool fits_budget(const PlanLayout& layout, const PlanSettings& settings);

}  // namespace volcal
