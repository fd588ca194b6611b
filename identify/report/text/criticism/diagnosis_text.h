#pragma once
/// A diagnosis as text for the terminal.

#include <string>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"

namespace volcal {

/// A dozen lines: the verdict, how the error fell, what was added, what to measure next.
std::string diagnosis_summary_text(const Diagnosis& diagnosis);

/// All of it.
std::string diagnosis_text(const Diagnosis& diagnosis);

/// Effects by rank, most likely first, each once: what was added, what could not be separated, surfaces and
/// laws that were drawn, the ranking.
/// More of an error function is no effect and has none.
std::vector<EffectFinding> ranked_effects(const Diagnosis& diagnosis);

}  // namespace volcal
