#pragma once
/// What a fit does with outliers and noise, by the words that the command line knows.

#include <string>

#include "volcal/identify/solve/fit.h"

namespace volcal::cli {

/// "remove" or "list".
inline OutlierPolicy outlier_policy(const std::string& word) {
  return word == "remove" ? OutlierPolicy::Remove : OutlierPolicy::List;
}

/// "white" or "auto".
inline NoisePolicy noise_policy(const std::string& word) {
  return word == "white" ? NoisePolicy::White : NoisePolicy::Automatic;
}

}  // namespace volcal::cli
