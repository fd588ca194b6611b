#pragma once
/// An error budget for the terminal and as JSON.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "volcal/identify/errors/error_budget.h"

namespace volcal {

/// Causes, then the contributions that make up the error; all of them with `verbose`.
std::string error_budget_text(const ErrorBudget& budget, const std::string& tool, double coverage_factor,
                              bool verbose);
nlohmann::ordered_json error_budget_json(const ErrorBudget& budget);

}  // namespace volcal
