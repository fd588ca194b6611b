#pragma once
/// Where and for what the error of a result is stated: conditions, measured positions.

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/error_tables.h"

namespace volcal {

/// One line, "Stated for T_column 23.34 degC (mean of the campaign), ..."; empty without conditions.
std::string stated_for_text(std::span<const StatedCondition> conditions);
/// Of a result; empty where its errors depend on no condition; below it what the user stated in vain or
/// beyond the readings.
std::string conditions_text(const FitResult& result, const Conditions& conditions);
nlohmann::ordered_json conditions_json(const FitResult& result, const Conditions& conditions);

/// Throws InputError where an axis was measured over a part of its travel, or where the conditions lie beyond
/// those of the readings.
void require_within_readings(const FitResult& result, const Conditions& conditions);
/// Throws InputError for an error that was extrapolated: it names the axis that `position` is beyond the
/// readings of. `at`: "--at X=900", as the user gave it.
void require_measured(const std::string& at, const Machine& machine, const MeasuredTravel& measured,
                      const AxisPosition& position, const VolumetricError& error);
/// Throws InputError where the conditions lie beyond those of the readings.
void require_conditions_of_readings(const FitResult& result, const Conditions& conditions);

}  // namespace volcal
