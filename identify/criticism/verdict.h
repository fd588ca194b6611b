#pragma once
/// The verdict of a diagnosis, and its words.
///
/// In: a diagnosis whose findings, ladder and removed readings are listed, and what only the search knows.
/// Out: verdict and sentences. Amplitudes in the unit of the edge with U at 95 %. Names go before what has
/// none, that before sets of alternatives; the reserve that more remains: thresholds.h.

#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"

namespace volcal {

/// What the findings do not hold.
struct Remarks {
  bool more_is_known = false;  ///< effects were found after those that are reported
  std::vector<std::pair<std::string, std::string>> rejected;  ///< labels of what is no name, and why
  std::size_t removed_by_fit = 0;                             ///< readings that the outlier test had removed
};

void conclude(const Remarks& remarks, Diagnosis& diagnosis);

}  // namespace volcal
