#pragma once
/// Why an error is not visible, and what to measure: in the user's words, for the rank report.

#include <optional>
#include <string>
#include <vector>

#include "volcal/model/observation/measurement_model.h"

namespace volcal {

struct Explanation {
  std::string reason;
  std::string remedy;
};

/// "a, b and c"
std::string list_in_words(const std::vector<std::string>& words);

/// Nothing can be told of an error motion or a squareness of an axis that stands still.
std::optional<Explanation> explain_standing(const Campaign& campaign, const std::string& name);
/// Of an error that is not seen even when everything else is known.
Explanation explain_unseen(const Campaign& campaign, const std::string& name);
/// Of an error motion whose course between the readings nothing tells.
Explanation explain_few_positions(AxisName axis);
/// What tells an error from those that it can be exchanged with.
std::string remedy_for_mixture(const MeasurementModel& model, const std::string& error,
                               const std::vector<std::string>& partners);

/// Name of the straightness that displaces as a squareness does: this one in proportion to the position, the
/// straightness in any other course. Empty for other errors.
std::string straightness_beside(const std::string& name);

}  // namespace volcal
