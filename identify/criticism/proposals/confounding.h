#pragma once
/// Which hypotheses the readings hardly separate, and the smallest amplitude at which they would.
///
/// MDB: amplitude that is found with 80 % power. MIB (minimal identifiable bias): amplitude that is also told
/// apart from every rival of the catalogue with the same power. Projecting on the rival too leaves less of an
/// effect: with one column each, MIB = MDB / sin of the angle between the two.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/identify/criticism/data/diagnosis_data.h"

namespace volcal {

/// What a diagnosis was made from.
struct CriticismState {
  const LinearModel& model;
  const FitResult& result;
  const NoiseData& data;       ///< readings that chose
  const Projector& projector;  ///< of them, at the model reached
  std::span<const NoiseParameters> noise;
  const std::vector<Family>& families;
  const std::vector<FamilyTest>& tests;  ///< at the model reached
  double log10_level = 0.0;              ///< of one family's test
  double power = 0.8;
  int threads = 1;
};

/// The family of a finding at the shape that was found; nullopt when the family is not among those tested.
std::optional<Hypothesis> hypothesis_of(const EffectFinding& finding, std::span<const Family> families);
/// What was taken into the model: effects and changes of resolution.
std::vector<Hypothesis> accepted_hypotheses(const Diagnosis& diagnosis, std::span<const Family> families);

/// Fills `mib` and `mib_rival` of all findings of the diagnosis, and its confounding matrix: effects that
/// were added, alternatives, then the ranking.
void add_confounding(const CriticismState& state, Diagnosis& diagnosis);

}  // namespace volcal
