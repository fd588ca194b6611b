#pragma once
/// A noise model in the words and units of the edge.

#include <string>

#include "volcal/identify/noise/noise_estimate.h"

namespace volcal {

struct EdgeNoise {
  double value = 0.0;  ///< 0 = off
  double low = 0.0;    ///< 95 % interval
  double high = 0.0;
  std::string unit;  ///< "um", "urad", "um or urad" (an instrument that reads both), "um/m", "s"; "" a factor
  std::string meaning;  ///< "correlated drift", "correlation time of the drift", ...
};

/// `instrument`: name of the kind that the row is of.
EdgeNoise edge_noise(const NoiseRow& row, const std::string& instrument);

}  // namespace volcal
