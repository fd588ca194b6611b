#pragma once
/// Why the readings do not tell effects from a model, and what to measure: the model's errors and effects
/// that move the readings as such an effect does.

#include <vector>

#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/identify/criticism/search/model_state.h"
#include "volcal/identify/words/sentences.h"

namespace volcal {

/// In the order of the tests, which are of the state. Memory: a column of all readings for each.
std::vector<Explanation> why_hidden(const ModelState& state, const std::vector<const FamilyTest*>& tests);

}  // namespace volcal
