#pragma once
/// Where and for what the error of a result is stated: conditions, measured positions.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "volcal/identify/errors/error_field.h"

namespace volcal {

/// One line, "Stated for T_column 23.34 degC (mean of the campaign), ..."; empty where the result's errors
/// depend on no condition.
std::string conditions_text(const FitResult& result, const Conditions& conditions);
nlohmann::ordered_json conditions_json(const FitResult& result, const Conditions& conditions);

/// Throws InputError where an axis was measured over a part of its travel.
void require_measured_travel(const FitResult& result);

}  // namespace volcal
