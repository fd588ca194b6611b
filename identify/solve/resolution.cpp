#include "volcal/identify/solve/resolution.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "volcal/model/functions/registry.h"

namespace volcal {
namespace {

constexpr double kDistinctShareOfTravel = 1.0 / 200.0;
constexpr double kLeastRange = 1e-12;  // m or rad: an axis that did not move

FunctionSpec resolved(FunctionSpec function, ErrorSymbol symbol, const Campaign& campaign) {
  const BasisKind* kind = find_basis(function.basis);
  if (kind == nullptr || !kind->uses_knots || function.knots == KnotChoice::Explicit) return function;
  const Axis& axis = campaign.machine.axis(symbol.axis);
  const int intervals = function.knots == KnotChoice::IntervalCount
                            ? function.intervals
                            : automatic_intervals(campaign, symbol.axis);
  function.breakpoints = uniform_breakpoints(axis, intervals);
  return function;
}

/// Of readings that are not left out.
template <class Visit>
void for_each_measured_position(const Campaign& campaign, AxisName axis, const Visit& visit) {
  for (const Setup& setup : campaign.setups) {
    const std::vector<bool> left_out = setup.rows_left_out();
    const std::vector<double>& own = setup.readings.position[index_of(axis)];
    for (std::size_t row = 0; row < own.size(); ++row) {
      if (!left_out[row]) visit(own[row]);
    }
  }
}

}  // namespace

int automatic_intervals(const Campaign& campaign, AxisName axis) {
  const double resolution = campaign.machine.axis(axis).travel() * kDistinctShareOfTravel;
  std::set<long> distinct;
  for_each_measured_position(campaign, axis, [&](double q) { distinct.insert(std::lround(q / resolution)); });
  return std::clamp(static_cast<int>(distinct.size()) - 1, 1, kMaxAutomaticIntervals);
}

ModelSpec resolve_knots(const ModelSpec& spec, const Campaign& campaign) {
  ModelSpec result = spec;
  for (const Axis& axis : campaign.machine.axes) {
    for (const Component component : kAllComponents) {
      const ErrorSymbol symbol{component, axis.name};
      if (is_rotary(axis.name) && !spec.functions.contains(symbol)) continue;
      result.functions[symbol] = resolved(spec.function(symbol), symbol, campaign);
    }
  }
  return result;
}

MeasuredRange measured_range(const Campaign& campaign, AxisName axis) {
  MeasuredRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for_each_measured_position(campaign, axis, [&](double q) {
    range.min = std::min(range.min, q);
    range.max = std::max(range.max, q);
  });
  return range;
}

double MeasuredRange::scaled(double position) const {
  return std::clamp(2.0 * (position - min) / std::max(kLeastRange, max - min) - 1.0, -1.0, 1.0);
}

}  // namespace volcal
