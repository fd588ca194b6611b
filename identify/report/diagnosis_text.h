#pragma once
/// A diagnosis as text for the terminal.

#include <string>

#include "volcal/identify/criticism/diagnosis.h"

namespace volcal {

std::string diagnosis_text(const Diagnosis& diagnosis);

}  // namespace volcal
