#pragma once
/// Which of the conditions that errors are stated for they depend on.

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

/// Of list_conditions() those, and what the user stated.
std::vector<StatedCondition> acting_conditions(const FitResult& result, const Conditions& conditions);

}  // namespace volcal
