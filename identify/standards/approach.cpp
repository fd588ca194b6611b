#include "volcal/identify/standards/approach.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "volcal/identify/standards/target_positions.h"

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

std::vector<int> axis_approach(const Readings& readings, AxisName axis) {
  const auto& position = readings.position[index_of(axis)];
  const auto& column = readings.direction[index_of(axis)];
  std::vector<int> approach(readings.size(), 0);
  if (position.empty()) return approach;
  for (const Pass& pass : passes(readings)) {
    std::vector<double> along;
    for (const std::size_t row : pass.rows) along.push_back(position[row]);
    const auto [low, high] = std::ranges::minmax(along);
    const bool moves = high - low > kStandingRange;
    const std::vector<int> from_order =
        moves ? approach_from_order(along) : std::vector<int>(along.size(), 0);
    for (std::size_t k = 0; k < pass.rows.size(); ++k) {
      const std::size_t row = pass.rows[k];
      const int stated = column.empty() ? 0 : column[row];
      approach[row] = stated != 0 ? stated : from_order[k];
    }
  }
  return approach;
}

}  // namespace volcal
