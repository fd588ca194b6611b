#pragma once
/// How far an axis has travelled since it last turned round, from one reading to the next.

#include <vector>

#include "volcal/model/effects/effect.h"

namespace volcal {

/// Per reading of a setup, m or rad, in the order of time where it is recorded, of the rows where it is not;
/// infinity until the axis first turns, and where the rows are no path. An axis that went back and comes from
/// the same side again has turned as well. Where it turned between two readings is not known: the travel
/// counts from the earlier one, from 0 where the axis came from further back. Moves as recorded_moves.h has
/// them.
std::vector<double> travel_since_turning(const Machine& machine, const Setup& setup, AxisName axis);
/// The same, as far as ever until the axis first turns.
std::vector<double> finite_travel_since_turning(const Machine& machine, const Setup& setup, AxisName axis);

}  // namespace volcal
