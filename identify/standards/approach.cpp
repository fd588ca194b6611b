#include "volcal/identify/standards/approach.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "volcal/identify/standards/target_positions.h"
#include "volcal/model/description/recorded_moves.h"

namespace volcal {

std::vector<Pass> passes(const Readings& readings) {
  std::vector<Pass> result;
  std::unordered_map<std::int32_t, std::size_t> index;
  for (std::size_t row = 0; row < readings.size(); ++row) {
    const std::int32_t line = readings.line.empty() ? 0 : readings.line[row];
    const auto [place, is_new] = index.try_emplace(line, result.size());
    if (is_new) result.push_back({line, {}});
    result[place->second].rows.push_back(row);
  }
  return result;
}

std::vector<int> approach_from_order(std::span<const double> positions) {
  const std::size_t count = positions.size();
  std::vector<int> approach(count, 0);
  const std::vector<std::size_t> target = group_targets(positions, kSamePosition).group;
  const auto move_to = [&](std::size_t k) {
    const double move = positions[k] - positions[k - 1];
    if (target[k] == target[k - 1] || std::abs(move) <= kSamePosition) return 0;
    return move > 0.0 ? 1 : -1;
  };
  int next_move = 0;
  for (std::size_t k = count; k-- > 0;) {
    const int move = k > 0 ? move_to(k) : 0;
    approach[k] = move != 0 ? move : next_move;
    if (move != 0) next_move = move;
  }
  for (std::size_t k = 1; k < count; ++k) {
    if (approach[k] == 0) approach[k] = approach[k - 1];  // at rest at the end of the pass
  }
  return approach;
}

namespace {

/// Rows from one move of half a turn to the next: within them the order tells every direction.
std::vector<std::vector<std::size_t>> stretches(const std::vector<std::size_t>& rows,
                                                const RecordedMoves& moves) {
  std::vector<std::vector<std::size_t>> parts;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (k == 0 || moves.either_way(rows[k - 1], rows[k])) parts.emplace_back();
    parts.back().push_back(rows[k]);
  }
  return parts;
}

/// Positions of a stretch, turns counted on.
std::vector<double> unrolled(const std::vector<std::size_t>& rows, const std::vector<double>& position,
                             const RecordedMoves& moves) {
  std::vector<double> along = {position[rows.front()]};
  for (std::size_t k = 1; k < rows.size(); ++k) {
    along.push_back(moves.modulo_a_turn() ? along.back() + moves.between(rows[k - 1], rows[k])
                                          : position[rows[k]]);
  }
  return along;
}

std::vector<int> approach_along(const std::vector<double>& along) {
  const auto [low, high] = std::ranges::minmax(along);
  return high - low > kStandingRange ? approach_from_order(along) : std::vector<int>(along.size(), 0);
}

}  // namespace

std::vector<int> axis_approach(const Machine& machine, const Readings& readings, AxisName axis) {
  const auto& position = readings.position[index_of(axis)];
  const auto& column = readings.direction[index_of(axis)];
  std::vector<int> approach(readings.size(), 0);
  if (position.empty()) return approach;
  const RecordedMoves moves(machine, readings, axis);
  for (const Pass& pass : passes(readings)) {
    bool after_half_a_turn = false;
    for (const std::vector<std::size_t>& rows : stretches(pass.rows, moves)) {
      const std::vector<int> from_order = approach_along(unrolled(rows, position, moves));
      for (std::size_t k = 0; k < rows.size(); ++k) {
        const int stated = column.empty() ? 0 : column[rows[k]];
        const bool unknown = after_half_a_turn && k == 0;
        approach[rows[k]] = stated != 0 ? stated : (unknown ? 0 : from_order[k]);
      }
      after_half_a_turn = true;
    }
  }
  return approach;
}

std::size_t readings_after_half_turns(const Machine& machine, const Readings& readings, AxisName axis) {
  const RecordedMoves moves(machine, readings, axis);
  std::size_t count = 0;
  for (const Pass& pass : passes(readings)) {
    const std::size_t parts = stretches(pass.rows, moves).size();
    count += parts - std::min<std::size_t>(parts, 1);
  }
  return count;
}

}  // namespace volcal
