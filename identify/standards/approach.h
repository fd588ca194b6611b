#pragma once
/// Direction in which positions were approached: from the `dir_*` columns, or else from the order of the
/// readings.

#include <span>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/machine.h"

namespace volcal {

/// Commanded positions closer than this (m; for rotary axes rad) are one.
inline constexpr double kSamePosition = 1e-6;

/// An axis whose positions in a pass lie within this (m or rad) stands still; what is recorded is scatter.
inline constexpr double kStandingRange = 10e-6;

/// Rows of one pass, in the order in which they were read.
struct Pass {
  std::int32_t line = 0;
  std::vector<std::size_t> rows;
};
/// The setup's passes by `line`; one pass when there is no such column. Order of first appearance.
std::vector<Pass> passes(const Readings& readings);

/// +1 or -1 per position: the sign of the last move between targets (target_positions.h). A position met
/// again without a move between is taken to be approached in the sense of the next move (the axis overran it
/// and came back), and so is the first one. 0 when nothing moves.
std::vector<int> approach_from_order(std::span<const double> positions);

/// Approach of an axis at every row: its `dir_` column where that says something, else the order of the
/// commanded positions within each pass in which it moves. Where an axis without end is recorded within one
/// turn, it took the shorter way (recorded_moves.h); half a turn has none. 0 = unknown.
std::vector<int> axis_approach(const Machine& machine, const Readings& readings, AxisName axis);
/// Readings to which an axis came by half a turn, from either side.
std::size_t readings_after_half_turns(const Machine& machine, const Readings& readings, AxisName axis);

}  // namespace volcal
