#pragma once
/// What moves the readings and has no name, as a diagnosis reports it.
///
/// In: the tested state that a search has reached, and what was rejected as a name. Out: variables, direction
/// and size (m, root mean square over the readings), leading first; log10 p family-wise. Of scans that exceed
/// nearly alike the simplest stands first, and a second variable is only reported where no other does as well
/// (margins: thresholds.h). Valid for what is recorded with the readings.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/criticism/search/rejection.h"

namespace volcal {

std::vector<UnknownFinding> unknown_findings(const ModelState& reached, const Reasons& rejected);

/// The direction whose share in the readings is most like that of a change.
ScanDirection direction_of_change(const LinearModel& model, const Eigen::VectorXd& moved);

/// Where another variable beside the same one explains nearly as much as the second of the leading finding,
/// the first alone is certain, and the others are one of several.
void report_what_is_certain(std::vector<UnknownFinding>& unknown);

}  // namespace volcal
