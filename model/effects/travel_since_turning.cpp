#include "volcal/model/effects/travel_since_turning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "volcal/model/description/recorded_moves.h"

namespace volcal {
namespace {

std::vector<std::size_t> order_of_reading(const Readings& readings) {
  std::vector<std::size_t> order(readings.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (!readings.time.empty())
    std::ranges::stable_sort(order, {}, [&](std::size_t row) { return readings.time[row]; });
  return order;
}

}  // namespace

std::vector<double> travel_since_turning(const Machine& machine, const Setup& setup, AxisName axis) {
  const Readings& readings = setup.readings;
  const auto& direction = readings.direction[index_of(axis)];
  std::vector<double> travelled(readings.size(), std::numeric_limits<double>::infinity());
  if (direction.empty()) return travelled;
  const RecordedMoves moves(machine, readings, axis);
  const std::vector<std::size_t> order = order_of_reading(readings);
  for (std::size_t i = 1; i < order.size(); ++i) {
    const std::size_t now = order[i], before = order[i - 1];
    const double move = moves.between(before, now);
    const double step =
        moves.either_way(before, now) ? std::abs(direction[now] * move) : direction[now] * move;
    const bool turned = step < 0.0 || direction[now] != direction[before];
    travelled[now] = turned ? std::max(step, 0.0) : travelled[before] + step;
  }
  return travelled;
}

std::vector<double> finite_travel_since_turning(const Machine& machine, const Setup& setup, AxisName axis) {
  std::vector<double> travelled = travel_since_turning(machine, setup, axis);
  double farthest = 0.0;
  for (const double each : travelled) farthest = std::isinf(each) ? farthest : std::max(farthest, each);
  for (double& each : travelled) each = std::min(each, farthest);
  return travelled;
}

}  // namespace volcal
