#include "volcal/identify/session/proposed_measurements.h"

#include <algorithm>
#include <cmath>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/effect_findings.h"
#include "volcal/identify/criticism/proposals/next_measurement.h"

namespace volcal {
namespace {

constexpr std::size_t kCompared = 12;  // with the leading effect

/// Above the noise, with a name and not in the model; best first.
std::vector<const FamilyTest*> leading_tests(const ModelState& state) {
  std::vector<const FamilyTest*> leading;
  for (const std::size_t family : state.tests().exceeding) {
    const FamilyTest& test = state.tests().families[family];
    if (!state.setting().families[test.family].effect || state.has(test.family)) continue;
    leading.push_back(&test);
    if (leading.size() == kCompared) break;
  }
  return leading;
}

/// The leading effect and its rivals.
std::vector<EffectFinding> alternatives(const ModelState& state) {
  const std::vector<const FamilyTest*> leading = leading_tests(state);
  if (leading.empty()) return {};
  const auto count = static_cast<Eigen::Index>(leading.size());
  Eigen::MatrixXd moved(static_cast<Eigen::Index>(state.model().size()), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const FamilyTest& test = *leading[static_cast<std::size_t>(k)];
    moved.col(k) = displacement(state.model(), state.setting().families[test.family], test);
  }
  const Eigen::MatrixXd gram = state.projector().project(moved).gram(0, count);
  std::vector<EffectFinding> set{finding(state.setting(), *leading.front())};
  for (Eigen::Index k = 1; k < count; ++k) {
    const double size = std::sqrt(std::max(0.0, gram(0, 0) * gram(k, k)));
    if (size > 0.0 && std::abs(gram(0, k)) > kRivalCosine * size)
      set.push_back(finding(state.setting(), *leading[static_cast<std::size_t>(k)]));
  }
  return set;
}

std::vector<EffectFinding> not_visible(const ModelState& state) {
  std::vector<EffectFinding> hidden;
  for (const FamilyTest& test : state.tests().families) {
    const bool seen = test.score.dof > 0 && test.score.visible_fraction >= kThresholds.visible_fraction;
    if (!seen && state.setting().families[test.family].effect && !state.has(test.family))
      hidden.push_back(finding(state.setting(), test));
  }
  return hidden;
}

}  // namespace

std::vector<MeasurementProposal> proposed_measurements(const ModelState& state, const FitResult& result) {
  Diagnosis asked;
  for (const AddedEffect& added : state.added())
    asked.effects.push_back(finding(state.setting(), added.test));
  asked.one_of = alternatives(state);
  if (asked.one_of.empty()) {
    asked.verdict = Verdict::NotVisible;
    asked.not_visible = not_visible(state);
  }
  const NoiseData data = without(state.model().problem().data, state.setting().heldout);
  const CriticismState criticised{state.model(),
                                  result,
                                  data,
                                  state.projector(),
                                  state.noise(),
                                  state.setting().families,
                                  state.tests().families,
                                  state.setting().log10_level(),
                                  kThresholds.power,
                                  state.setting().threads};
  add_next_measurements(criticised, {}, asked);
  return asked.proposals;
}

}  // namespace volcal
