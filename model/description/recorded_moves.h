#pragma once
/// Moves of an axis between recorded positions. Many controls record an axis that turns without end within
/// one turn: from 330 deg it moves on to 0.

#include <cstddef>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/machine.h"

namespace volcal {

class RecordedMoves {
 public:
  /// `readings` must live as long.
  RecordedMoves(const Machine& machine, const Readings& readings, AxisName axis);

  /// Whether a turn more or less cannot be told: an axis without end whose positions lie within one turn.
  bool modulo_a_turn() const { return modulo_a_turn_; }
  /// From one row to another, m or rad: the difference; modulo a turn the shorter way, -pi to pi.
  double between(std::size_t from, std::size_t to) const;
  /// Half a turn: either way is as short, and neither sign of the move says anything.
  bool either_way(std::size_t from, std::size_t to) const;

 private:
  const std::vector<double>& position_;
  bool modulo_a_turn_;
};

}  // namespace volcal
