#pragma once
/// Judging a step on readings that did not choose it.

#include <span>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/search/heldout_errors.h"
#include "volcal/identify/criticism/search/model_state.h"

namespace volcal {

/// Every tenth line (or the given share) of every setup; where a setup has fewer lines than that, stretches
/// of ten readings instead. Spread evenly, the same for every run.
std::vector<bool> heldout_lines(const LinearModel& model, double share);
/// Of every setup the line of each reading, counted from 0, or the stretch of ten that it stands in: what is
/// held out together.
std::vector<std::vector<int>> heldout_groups(const Campaign& campaign, double share);
/// The same choice by setup and row.
std::vector<std::vector<bool>> heldout_rows(const Campaign& campaign, double share);

/// Variance of every observation on its own, all parts of the noise; SI squared.
std::vector<double> noise_variance(const NoiseData& data, std::span<const NoiseParameters> noise);

/// The names explain the readings that they were chosen on, and not those that were held out: these are still
/// off by more than noise, and by at least four fifths of what they were before.
bool heldout_error_not_reduced(std::span<const LadderStep> ladder);

/// The given model, then with every added effect, all against the noise of the model reached: noise estimated
/// without an effect holds part of it, and would hide its fall.
std::vector<LadderStep> ladder_of(const ModelState& state);

/// The last step alone.
LadderStep last_step_of(const ModelState& state);
/// Against another noise.
LadderStep last_step_at(const ModelState& state, const std::vector<NoiseParameters>& noise);
/// With the projector at that noise at hand.
LadderStep last_step_at(const ModelState& state, const std::vector<NoiseParameters>& noise,
                        const Projector& projector);

/// What the last step of a model stands on beside its residuals, kept: steps of the same model with effects,
/// at the same noise and smoothing and of the same readings, follow from it (heldout_errors.h). Equal to
/// rounding. Immutable.
class KeptFigures {
 public:
  /// `projector`: of `without_effects` at `noise`.
  KeptFigures(const ModelState& without_effects, std::vector<NoiseParameters> noise,
              const Projector& projector);
  /// last_step_at() the noise of `state`, the model with effects; its residuals may be others.
  LadderStep last_step(const ModelState& state, const Projector& projector) const;

 private:
  std::vector<NoiseParameters> noise_;
  std::vector<double> variance_;  ///< of every observation
  double prior_rank_;
  bool is_regular_;
  HeldoutErrors errors_;
};

/// The last step with a further effect, at the same noise and smoothing.
LadderStep ladder_step_beside(const ModelState& state, const FamilyTest& effect);

/// The last step with another effect in the place of an added one, at the same noise and smoothing.
LadderStep ladder_step_with(const ModelState& state, std::size_t added, const FamilyTest& instead);

}  // namespace volcal
