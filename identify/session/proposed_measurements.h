#pragma once
/// What to measure next, at a model of a session: of what a diagnosis proposes (next_measurement.h), what
/// tells the leading effect from those that the readings hardly tell from it; where nothing is above the
/// noise, what shows effects that no reading feels.

#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/search/model_state.h"
#include "volcal/identify/result/result.h"

namespace volcal {

/// Cosine, after projection off the model, of effects that readings hardly tell apart.
inline constexpr double kRivalCosine = 0.7;

/// `state` with its tests, about `result`.
std::vector<MeasurementProposal> proposed_measurements(const ModelState& state, const FitResult& result);

}  // namespace volcal
