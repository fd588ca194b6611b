#pragma once
/// diagnosis.json: the verdict of model criticism for programs. Amplitudes in their edge units, um elsewhere.

#include <string>

#include "volcal/identify/criticism/diagnosis.h"

namespace volcal {

inline constexpr const char* kDiagnosisFormat = "volcal-diagnosis-1";

std::string diagnosis_json(const Diagnosis& diagnosis);

}  // namespace volcal
