#pragma once
/// Which measurement next: of everything on the menu (candidates/candidate_measurements.h), the one that
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

#include <string>
#include <vector>

#include "volcal/identify/criticism/proposals/confounding.h"

namespace volcal {

struct MeasurementProposal {
  std::string action;                     ///< entry of the menu; empty: nothing on the menu helps
  std::string setup;                      ///< setup that it continues; empty = a new one
  std::vector<EffectName> separates;      ///< two hypotheses, or none
  std::vector<EffectName> makes_visible;  ///< of effects that are not
  std::size_t readings = 0;
  double separation = 0.0;  ///< s^2 as it is
  double gain = 0.0;        ///< s^2 with the measurement over s^2; infinite when it is 0 as it is
  double plain_gain = 0.0;  ///< with as many plain readings
  double reached = 0.0;     ///< s^2 with the measurement; 0 when it makes effects visible
  double plain = 0.0;       ///< s^2 with as many plain readings
  std::string words;
};

struct PlanningOptions {
  std::size_t readings = 48;         ///< that a measurement may take, about
  std::vector<EffectSpec> separate;  ///< hypotheses that the user wants told apart, or seen if it is one
};

/// Fills `next_measurement` and `proposals` of the diagnosis: for the alternatives of ONE_OF, for what the
/// user asks about, and with the verdict NOT_VISIBLE for what is not visible. Throws InputError when the user
/// asks about an effect that the model already has.
void add_next_measurements(const CriticismState& state, const PlanningOptions& options, Diagnosis& diagnosis);

}  // namespace volcal
