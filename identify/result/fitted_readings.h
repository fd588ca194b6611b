#pragma once
/// Which readings a result was made from: a fingerprint of every setup's content is kept with it, whatever
/// the files and setups are called.

#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// Of instrument, commanded positions and readings that are not left out, in any order: 16 hexadecimal
/// digits, then those of every row that is left out; empty where no row is in use.
std::string readings_fingerprint(const Setup& setup);

struct FittedReadings {
  bool is_known = false;            ///< the result says what it was made from
  std::vector<std::string> setups;  ///< of the campaign that the fit was made from
  std::size_t readings = 0;         ///< of these
  std::size_t all = 0;              ///< of the campaign
  std::size_t left_out = 0;         ///< of these setups: in use here, left out of the fit

  bool are_all() const { return readings > 0 && readings == all; }
};

FittedReadings fitted_readings(const Campaign& campaign, const FitResult& result);

}  // namespace volcal
