#pragma once
/// What errors depend on: which of the conditions that they are stated for, and waves along an axis.

#include <set>
#include <vector>

#include "volcal/identify/errors/conditions.h"
#include "volcal/model/description/finding.h"

namespace volcal {

/// Temperatures, time and feed that the errors of any tool depend on.
std::set<Variable> conditions_that_act(const FitResult& result, const Conditions& conditions);

/// "errors.condition-beyond-readings" of what the errors depend on and the user stated beyond the campaign's
/// readings; of what a curve or surface depends on, whoever stated it.
std::vector<Finding> conditions_beyond_readings(const FitResult& result, const Conditions& conditions);

/// Of what the user stated and no error at a pose depends on: "errors.condition-without-effect",
/// "errors.condition-on-paths-alone", of errors of tables "errors.tables-of-other-conditions".
std::vector<Finding> conditions_in_vain(const FitResult& result, const Conditions& conditions);

/// Of list_conditions() those, and what the user stated.
std::vector<StatedCondition> acting_conditions(const FitResult& result, const Conditions& conditions);

/// Shortest period, m, of the effects of a result that are waves along a linear axis; infinite without one.
double shortest_wave(const FitResult& result, AxisName axis);

}  // namespace volcal
