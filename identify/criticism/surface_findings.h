#pragma once
/// What a diagnosis says of the surfaces that it has drawn for what has no name.
///
/// In: the tested state that a search has reached. Out: coefficients from all readings, held-out ones as
/// well, size and place of the largest value among the readings, what is not defined by them. SI but for
/// places, which are in the units in which users write of a driver (model/effects/recorded_variable.h).

#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/search/model_state.h"

namespace volcal {

std::vector<SurfaceFinding> surface_findings(const ModelState& reached);

}  // namespace volcal
