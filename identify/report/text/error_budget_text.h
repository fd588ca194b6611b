#pragma once
/// An error budget for the terminal and as JSON.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "volcal/identify/errors/volume/error_budget.h"
#include "volcal/model/description/tolerances.h"

namespace volcal {

/// Causes, then the contributions that make up the error; all of them with `verbose`.
std::string error_budget_text(const ErrorBudget& budget, const std::string& tool, double coverage_factor,
                              bool verbose);
nlohmann::ordered_json error_budget_json(const ErrorBudget& budget);

/// The same of a machine at the design stage (design_stage.h): what is expected of its tolerances.
std::string design_budget_text(const ErrorBudget& budget, const Machine& machine,
                               const Tolerances& tolerances, const std::string& tool, bool verbose);
nlohmann::ordered_json design_budget_json(const ErrorBudget& budget, const Machine& machine,
                                          const Tolerances& tolerances);

}  // namespace volcal
