#include "volcal/model/description/campaign.h"

namespace volcal {

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

}  // namespace volcal
