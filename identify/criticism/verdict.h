#pragma once
/// The verdict of a diagnosis, and what it says.
///
/// In: a diagnosis whose findings, ladder and removed readings are listed, and what only the search knows.
/// Out: verdict and findings "diagnosis...". Amplitudes with U at 95 %. Names go before what has
/// none, that before sets of alternatives; the reserve that more remains: thresholds.h.

#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"

namespace volcal {

/// What the findings do not hold.
struct Remarks {
  bool more_is_known = false;          ///< effects were found after those that are reported
  std::vector<Finding> rejected = {};  ///< what is no name, and why: "diagnosis.rejected..."
  std::size_t removed_by_fit = 0;      ///< readings that the outlier test had removed
};

void conclude(const Remarks& remarks, Diagnosis& diagnosis);
/// What is said of something without a name: "diagnosis.unknown".
Finding unnamed(const UnknownFinding& unknown);
/// What became of the effects that the user thought of; after the verdict and the confounding matrix.
void conclude_tried(Diagnosis& diagnosis);

}  // namespace volcal
