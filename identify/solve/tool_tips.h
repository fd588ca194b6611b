#pragma once
/// What the tools of a campaign can tell of the rotations of an axis.

#include <optional>
#include <set>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/machine_error.h"

namespace volcal {

/// The linear axis whose direction a squareness turns; nothing for other errors.
std::optional<AxisName> turned_axis(const MachineError& error);

/// Tools, by their places in the machine file, with which readings stand at more than one position of an
/// axis: the others tell nothing of its errors.
std::set<std::size_t> tools_moved_by(const Campaign& campaign, AxisName axis);

/// To which side a third tool helps, 'X', 'Y' or 'Z': where the tips of all tools that the axis of the error
/// moves lie on one line, and
/// an error and what it can be exchanged with are rotations of one axis and what goes with them. Nothing
/// moves the tips when the axis turns about that line. Nothing otherwise.
std::optional<char> third_tool_across(const Campaign& campaign, const MachineError& error,
                                      const std::vector<MachineError>& partners);

}  // namespace volcal
