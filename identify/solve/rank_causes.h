#pragma once
/// Why an error is not visible, and what to measure: findings "rank.not-visible...", for the rank report.

#include <optional>
#include <vector>

#include "volcal/model/description/finding.h"
#include "volcal/model/description/machine_error.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

/// Nothing can be told of an error motion or a squareness of an axis that stands still.
std::optional<Finding> cause_of_standing(const Campaign& campaign, const MachineError& error);
/// Of an error that is not seen even when everything else is known.
Finding cause_of_unseen(const Campaign& campaign, const MachineError& error);
/// Of an error motion whose course between the readings nothing tells, though they see it; `unknowns`: as
/// many as its function has. Too few positions, where they are, of a rotary axis with the periods a turn that
/// they tell; else readings that are too few or too noisy.
Finding cause_of_open_course(const MeasurementModel& model, ErrorSymbol symbol, int unknowns);
/// Of a squareness that positions along its axis would tell from a straightness.
Finding cause_like_straightness(const MachineError& squareness, ErrorSymbol straightness);
/// Of an error that can be exchanged with others, and what tells it from them.
Finding cause_exchangeable(const MeasurementModel& model, const MachineError& error,
                           const std::vector<MachineError>& partners);

/// Positions of an axis at which readings stand and that differ by more than a thousandth of its travel,
/// ascending, m or rad.
std::vector<double> different_positions(const Campaign& campaign, AxisName axis);

/// The straightness that displaces as a squareness does: this one in proportion to the position, the
/// straightness in any other course. Absent for other errors.
std::optional<ErrorSymbol> straightness_beside(const MachineError& error);

}  // namespace volcal
