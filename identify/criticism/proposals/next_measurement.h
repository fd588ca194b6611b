#pragma once
/// Which measurement next: of all candidates (candidates/candidate_measurements.h), the one that
/// would tell hypotheses apart that the readings cannot, or make an effect visible that is not.
///
/// With the readings that a measurement would add, hypotheses f and r stand
///
///   s^2 = min( a_f^T G_f|r a_f, a_r^T G_r|f a_r )
///
/// apart (separation.h), G being what is left after projection off the model and the new nuisance parameters.
/// The measurement whose smallest s^2 over all pairs is largest is proposed (T-optimality: Atkinson and
/// Fedorov 1975, Biometrika 62, 57). Amplitudes are the estimates; of an effect that is not significant,
/// those that would just be detected and are nearest to the rival. What is gained is compared with as many
/// further readings of the kind that the campaign already has.

#include "volcal/identify/criticism/proposals/confounding.h"

namespace volcal {

/// Fills `next_measurement` and `proposals` of the diagnosis: for the alternatives of ONE_OF, for what the
/// user asks about, and with the verdict NOT_VISIBLE for what is not visible. Throws InputError when the user
/// asks about an effect that the model already has.
void add_next_measurements(const CriticismState& state, const PlanningOptions& options, Diagnosis& diagnosis);

}  // namespace volcal
