#pragma once
/// What stands between the positions of an axis that were measured and those that were not.

#include <limits>

#include "volcal/model/description/machine.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

/// First and last position with readings, m or rad; without ends unless they are given. An axis that goes
/// round is taken to its positions modulo a turn: C at 360 deg stands where it stands at 0.
struct MeasuredEnds {
  double first = -std::numeric_limits<double>::infinity();
  double last = std::numeric_limits<double>::infinity();
  bool goes_round = false;

  /// The nearest position that was measured, on the circle where the axis goes round.
  double nearest(double position) const;
  /// Further from the measured positions than a micrometre or a microradian.
  bool is_beyond(double position) const;
  /// No position of the axis is beyond.
  bool cover(const Axis& axis) const;
};

/// Whether positions a turn apart are one position of an axis in an identified model: it travels a turn, and
/// its error motions are Fourier series, or polylines over whole turns that end with the value they begin
/// with.
bool goes_round(const Axis& axis, const ModelSpec& model);

/// Whether readings were at one position of a rotary axis of which the model has no error motions.
bool stood_still(AxisName axis, const ModelSpec& model);

/// Of an axis in a model that states what was measured; without ends where it stood still.
MeasuredEnds measured_ends(const Axis& axis, const ModelSpec& model);

}  // namespace volcal
