#pragma once
/// Whether anything recorded moves the residuals of an adjusted campaign: the score tests of the catalogue
/// and the scans without a catalogue of a diagnosis, once, at the noise and smoothing of the fit. It costs a
/// fifth of the fit or less, names nothing, and says whether a diagnosis pays.

#include <cstddef>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// Nothing is tested without readings to spare. `result` must come from fit() of this campaign. Noise that is
/// more than white is not exactly known: a test then counts from a much smaller probability on. Readings that
/// the outlier test flags are left out, unless they are most of their setup. Campaigns of more readings or
/// setups than the tests need are tested on an even choice of them. The same for any number of threads.
Screening screen(const Campaign& campaign, const FitResult& result, int threads,
                 std::size_t most_observations = kThresholds.screening_most_observations,
                 std::size_t most_setups = kThresholds.screening_most_setups);

/// Of readings against a finished fit, whose errors are held: `evaluated` (as_fitted(), evaluate.h), where
/// stations and the like are free alone, by screen(). Where all of them are the readings that the fit was
/// made from, the more improbable of that and what the fit's own tests found, with the error functions free,
/// too.
Screening screen_evaluated(const Campaign& campaign, const FitResult& evaluated, const FitResult& fitted,
                           int threads);

/// screen() and judge() with the time that they took. Nothing where there are no residuals to test: a robust
/// loss has no likelihood, an adjustment that did not converge none to trust.
void screen_fit(const Campaign& campaign, const FitOptions& options, FitResult& result);

/// fit() and screen_fit(), progress over both.
FitResult screened_fit(const Campaign& campaign, const ModelSpec& model, const FitOptions& options);

/// A fit that a test contradicts lacks something: status Ok becomes LackOfFit, and a finding says so. Another
/// one, the first of all, names setups whose sign or unit seems to be another.
void judge(const Screening& screening, FitResult& result);

}  // namespace volcal
