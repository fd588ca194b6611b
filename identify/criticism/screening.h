#pragma once
/// Whether anything recorded moves the residuals of an adjusted campaign: the score tests of the catalogue
/// and the scans without a catalogue of a diagnosis, once, at the noise and smoothing of the fit. It costs a
/// fifth of the fit or less, names nothing, and says whether a diagnosis pays.

#include <string>

#include "volcal/identify/solve/result.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

struct Screening {
  std::size_t tests = 0;
  bool contradicts = false;  ///< a test is above the noise
  std::string leading;       ///< the most improbable: "EAX by z^2", "something that depends on z along Z"
  double log10_p = 0.0;      ///< its, family-wise
  double rms = 0.0;          ///< SI: root mean square over the readings of what it would explain
};

/// Nothing is tested without readings to spare. `result` must come from fit() of this campaign. Noise that is
/// more than white is not exactly known: a test then counts from a much smaller probability on. Readings that
/// the outlier test flags are left out. The same for any number of threads.
Screening screen(const Campaign& campaign, const FitResult& result, int threads);

/// A fit that a test contradicts lacks something: status Ok becomes LackOfFit, and a message says so.
void judge(const Screening& screening, FitResult& result);

/// The sentence for it; empty where nothing contradicts.
std::string screening_sentence(const Screening& screening);

}  // namespace volcal
