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

/// Of a diagnosis that removed readings: what `volcal fit` does with them, and the line that leaves them out.
/// Empty where none was removed.
std::string removed_in_fit_text(const Diagnosis& diagnosis, const std::string& campaign,
                                const std::string& model);

/// Effects by rank, most likely first, each once: what was added, what could not be separated, surfaces and
/// laws that were drawn, the ranking.
/// More of an error function is no effect and has none.
std::vector<EffectFinding> ranked_effects(const Diagnosis& diagnosis);

}  // namespace volcal
