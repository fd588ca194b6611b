#pragma once
/// A campaign and a result made by hand, with everything that a report shows: several instruments, an error
/// that is not visible, one that is switched off, extrapolated positions, suspect readings, priors.

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"

namespace volcal::test {

struct SyntheticFit {
  Campaign campaign;
  FitResult result;
};

/// `scale` multiplies the number of readings.
SyntheticFit synthetic_fit(int scale = 1);

}  // namespace volcal::test
