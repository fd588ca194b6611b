#pragma once
/// Resolution of error functions with `knots = "auto"`: as many pieces as the measured positions can tell
/// apart, with the smoothing prior of smoothing.h deciding by evidence how much of that resolution the data
/// support.

#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

inline constexpr int kMaxAutomaticIntervals = 24;
inline constexpr int kMostAutomaticHarmonics = 12;  ///< of a Fourier series

/// The stretch of an axis that is resolved: the travel, or the measured part where this ends more than one
/// interval before the travel does; m or rad. Outside, pieces double in length.
struct ResolvedStretch {
  double min = 0.0;
  double max = 0.0;
  int intervals = 1;

  bool is_whole(const Axis& axis) const { return min == axis.travel_min && max == axis.travel_max; }
  std::vector<double> breakpoints(const Axis& axis) const;
};

/// Intervals: measured positions that differ by more than 1/200 of the stretch, less one, at most
/// kMaxAutomaticIntervals, at least 1.
ResolvedStretch resolved_stretch(const Campaign& campaign, AxisName axis);
/// The same of an axis whose functions have these breakpoints: the whole travel where they are others.
ResolvedStretch resolved_stretch(const Campaign& campaign, AxisName axis,
                                 const std::vector<double>& breakpoints);
int automatic_intervals(const Campaign& campaign, AxisName axis);

/// The spec with the errors of rotary axes that move, with breakpoints for every function that uses knots,
/// and with the ranges of effects that leave them to the readings. `smoothed` functions keep
/// KnotChoice::Automatic.
ModelSpec resolve_knots(const ModelSpec& spec, const Campaign& campaign);

/// Range of commanded positions of an axis in the campaign, m or rad; rows that are left out do not count.
struct MeasuredRange {
  double min = 0.0;
  double max = 0.0;

  /// -1 at min ... 1 at max, and no further.
  double scaled(double position) const;
};
MeasuredRange measured_range(const Campaign& campaign, AxisName axis);

}  // namespace volcal
