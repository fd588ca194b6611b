// What depends on the direction of approach shows where a position is approached from both sides.
#include <fmt/format.h>

#include <algorithm>

#include "volcal/identify/criticism/proposals/candidates/hypothetical_readings.h"

namespace volcal {
namespace {

/// Whether an axis moves and is always approached from the same side, or from an unknown one.
bool one_sided(const Readings& readings, std::size_t axis) {
  const auto& direction = readings.direction[axis];
  const auto& position = readings.position[axis];
  if (position.empty()) return false;
  const auto [low, high] = std::ranges::minmax(position);
  if (!(high > low)) return false;
  const bool plus = std::ranges::find(direction, 1) != direction.end();
  const bool minus = std::ranges::find(direction, -1) != direction.end();
  return !(plus && minus);
}

/// Half of the readings from either side where the side was not recorded, else all from the other.
void reverse(std::vector<std::int8_t>& direction, std::size_t rows) {
  const bool recorded = std::ranges::any_of(direction, [](std::int8_t d) { return d != 0; });
  if (recorded) {
    for (std::int8_t& each : direction) each = static_cast<std::int8_t>(-each);
    return;
  }
  direction.resize(rows);
  for (std::size_t row = 0; row < rows; ++row) direction[row] = row % 2 == 0 ? 1 : -1;
}

}  // namespace

std::vector<ExtraMeasurement> opposite_approaches(const CandidateContext& context) {
  const auto alter = [](const Setup& measured, const Axis& axis, Readings& again) -> std::string {
    const std::size_t k = index_of(axis.name);
    if (!one_sided(measured.readings, k)) return {};
    reverse(again.direction[k], again.size());
    return {letter_of(axis.name)};
  };
  return altered_again(
      context, " from the other side", alter, [](const std::string& place, const std::string& axes) {
        return fmt::format("measure {} again, approaching {} from the other side", place, axes);
      });
}

}  // namespace volcal
