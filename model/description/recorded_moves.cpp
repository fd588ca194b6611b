#include "volcal/model/description/recorded_moves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace volcal {
namespace {

constexpr double kOneTurn = 2.0 * std::numbers::pi;
constexpr double kScatterOfAngles = 1e-3;  // rad, of positions where the axis stood

bool lie_within_a_turn(const std::vector<double>& positions) {
  if (positions.empty()) return false;
  const auto [low, high] = std::ranges::minmax(positions);
  return high - low <= kOneTurn + kScatterOfAngles;
}

}  // namespace

RecordedMoves::RecordedMoves(const Machine& machine, const Readings& readings, AxisName axis)
    : position_(readings.position[index_of(axis)]),
      modulo_a_turn_(machine.has_axis(axis) && machine.is_endless(axis) && lie_within_a_turn(position_)) {}

double RecordedMoves::between(std::size_t from, std::size_t to) const {
  const double difference = position_[to] - position_[from];
  return modulo_a_turn_ ? std::remainder(difference, kOneTurn) : difference;
}

bool RecordedMoves::either_way(std::size_t from, std::size_t to) const {
  return modulo_a_turn_ && std::abs(between(from, to)) > std::numbers::pi - kScatterOfAngles;
}

}  // namespace volcal
