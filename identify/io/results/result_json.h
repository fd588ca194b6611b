#pragma once
/// result.json: everything an identification found but its single residuals (residuals.csv), to the last bit.
/// Values are SI (m, rad, s, K); numbers that are not finite are the texts "nan", "inf", "-inf".

#include <string>

#include "volcal/identify/result/result.h"

namespace volcal {

inline constexpr const char* kResultFormat = "volcal-result-1";

std::string result_json(const FitResult& result);
/// The same without machine, model, parameters and covariance: for a reader who wants the verdict.
std::string result_summary_json(const FitResult& result);
/// Throws InputError naming `file` and, where possible, the line.
FitResult result_from_json(const std::string& text, const std::string& file);

}  // namespace volcal
