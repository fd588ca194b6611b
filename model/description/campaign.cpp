#include "volcal/model/description/campaign.h"

namespace volcal {

std::size_t Campaign::reading_count() const {
  std::size_t count = 0;
  for (const Setup& setup : setups) count += setup.readings.size() * setup.readings.channels();
  return count;
}

}  // namespace volcal
