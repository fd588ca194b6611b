#pragma once
/// What sets of alternatives mean for the machine: the readings do not tell the members apart, but the user
/// goes on with one of them.

#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/search/model_state.h"
#include "volcal/identify/result/result.h"

namespace volcal {

/// Of every added effect that has rivals, in their order: with each member in its place, what the held-out
/// readings leave, and by how much what it makes of the machine differs from what the member does that the
/// diagnosis goes on with.
///
/// The machine: displacements of the functional point (ISO/TR 16907:2015, 3.14) on a lattice of the measured
/// positions, both directions of approach, every tool in use, time and temperatures at their means; a
/// displacement common to all is no difference. First order in all parameters, shapes held; u from the
/// covariance of both members' amplitudes, which come from the same readings.
std::vector<SetFinding> alternative_sets(const ModelState& reached, const FitResult& result);

}  // namespace volcal
