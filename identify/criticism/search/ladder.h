#pragma once
/// Judging a step on readings that did not choose it.

#include <optional>
#include <span>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/identify/criticism/projection/projector.h"

namespace volcal {

/// Every tenth line (or the given share) of every setup; where a setup has fewer lines than that, stretches
/// of ten readings instead. Spread evenly, the same for every run.
std::vector<bool> heldout_lines(const LinearModel& model, double share);
/// The same choice by setup and row.
std::vector<std::vector<bool>> heldout_rows(const Campaign& campaign, double share);

/// Variance of every observation on its own, all parts of the noise; SI squared.
std::vector<double> noise_variance(const NoiseData& data, std::span<const NoiseParameters> noise);

/// The names explain the readings that they were chosen on, and not those that were held out: these are still
/// off by more than noise, and by at least four fifths of what they were before.
bool heldout_error_not_reduced(std::span<const LadderStep> ladder);

/// Figures of the model that `projector` holds, with the accepted columns; `loglik` is the held-out
/// log-likelihood of the step before, and becomes this one's.
LadderStep ladder_step(const LinearModel& model, const std::vector<bool>& heldout,
                       std::span<const NoiseParameters> noise, const Projector& projector,
                       const std::vector<Eigen::MatrixXd>& accepted, std::optional<double>& loglik);

}  // namespace volcal
