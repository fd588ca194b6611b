#include "volcal/model/description/campaign.h"

#include <algorithm>
#include <cctype>

namespace volcal {

std::array<double, kAxisCount> Readings::commanded_position(std::size_t row) const {
  std::array<double, kAxisCount> commanded{};
  for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
    if (!position[axis].empty()) commanded[axis] = position[axis][row];
  }
  return commanded;
}

std::vector<bool> Setup::rows_left_out() const {
  std::vector<std::size_t> channels(left_out.empty() ? 0 : readings.size(), 0);
  for (const LeftOutReading& reading : left_out) ++channels[reading.row];
  std::vector<bool> rows(readings.size(), false);
  for (std::size_t row = 0; row < channels.size(); ++row) rows[row] = channels[row] == readings.channels();
  return rows;
}

std::size_t Campaign::reading_count() const {
  std::size_t count = 0;
  for (const Setup& setup : setups) count += setup.readings.size() * setup.readings.channels();
  return count;
}

bool names_compensations(std::string_view active) {
  constexpr std::string_view kNone = "none";
  const auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
  return !active.empty() && !std::ranges::equal(active, kNone, same);
}

}  // namespace volcal
