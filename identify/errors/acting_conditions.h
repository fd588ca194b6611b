#pragma once
/// Which of the conditions that errors are stated for they depend on.

#include <set>
#include <vector>

#include "volcal/identify/errors/conditions.h"

namespace volcal {

/// Temperatures, time and feed that the errors of any tool depend on.
std::set<Variable> conditions_that_act(const FitResult& result, const Conditions& conditions);

/// Of list_conditions() those, and what the user stated.
std::vector<StatedCondition> acting_conditions(const FitResult& result, const Conditions& conditions);

}  // namespace volcal
