#pragma once
/// What `validate` says, for the terminal, as JSON and in the report.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "volcal/identify/result/fitted_readings.h"
#include "volcal/identify/solve/evaluate.h"

namespace volcal {

/// "Readings that the fit never saw".
std::string readings_seen_text(const FittedReadings& fitted);
/// That figures of readings which the fit was made from prove nothing, and what to do; empty where it was not
/// made from any.
std::string seen_readings_warning(const FittedReadings& fitted);

/// Adds to the notes of a campaign that judges errors which of its rotary axes they lack, where it goes
/// beyond their readings, and what tables hold that they were read from.
void note_judgement(const FitResult& errors, Campaign& campaign);

std::string validation_text(const Validation& validation, const FittedReadings& fitted);
nlohmann::ordered_json validation_json(const ValidationFigures& figures, const FittedReadings& fitted);

}  // namespace volcal
