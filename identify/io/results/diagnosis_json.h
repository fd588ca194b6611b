#pragma once
/// diagnosis.json: the verdict of model criticism for programs. Amplitudes in their edge units, um elsewhere.

#include <string>

#include "volcal/identify/criticism/data/diagnosis_data.h"

namespace volcal {

inline constexpr const char* kDiagnosisFormat = "volcal-diagnosis-1";

std::string diagnosis_json(const Diagnosis& diagnosis);

/// The same back, without figures; numbers to rounding, effects to be put into a model to the bit. `file`
/// names the text in errors. Throws InputError.
Diagnosis diagnosis_from_json(const std::string& text, const std::string& file);

/// diagnosis.json of a folder that `volcal diagnose` wrote, or the file itself. Throws InputError.
Diagnosis read_diagnosis(const std::string& path);

}  // namespace volcal
