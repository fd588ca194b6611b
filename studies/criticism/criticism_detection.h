#pragma once
/// Amplitudes that are found, against the smallest detectable ones that were stated.

#include <string>
#include <vector>

#include "volcal/studies/criticism/criticism_record.h"

namespace volcal::studies {

/// Amplitude found with 80 % power over the stated one, by a probit line through all campaigns.
struct Detection {
  std::string effect;
  int campaigns = 0;
  double ratio = 0.0;  ///< NaN when it is unknown
  double low = 0.0;    ///< 95 % interval
  double high = 0.0;
};
std::vector<Detection> detections_of(const Campaigns& campaigns);

}  // namespace volcal::studies
