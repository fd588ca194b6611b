#pragma once
/// Where the noise that a fit estimated is larger than the stated one: the difference may be an effect that
/// the noise model has taken for noise.

#include <map>
#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"

namespace volcal::report {

struct SwallowedNoise {
  std::size_t readings = 0;              ///< of which the estimated noise is larger by more than a twentieth
  std::map<std::string, double> groups;  ///< noise group (channels.h): root mean square factor of these
  std::vector<double> factor;            ///< per residual: estimated over stated sigma, at least 1
};

/// Factors of 1 where the fit does not hold its stated sigma (a result read from files).
SwallowedNoise swallowed_noise(const FitResult& result, const Campaign& campaign);

}  // namespace volcal::report
