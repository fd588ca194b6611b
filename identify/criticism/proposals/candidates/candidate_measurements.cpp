#include "volcal/identify/criticism/proposals/candidates/candidate_measurements.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

namespace volcal {

// One line per entry.
#define VOLCAL_CANDIDATES(ENTRY)                                                                     \
  ENTRY("revisit", "measure at a station again hours later, warm", revisits)                         \
  ENTRY("cold-start", "measure at a station again the next day, at the temperatures of the start",   \
        cold_starts)                                                                                 \
  ENTRY("second-tool", "measure at a station with another or a longer tool", second_tools)           \
  ENTRY("calibrated-length", "circles with a ball-bar of calibrated length", calibrated_lengths)     \
  ENTRY("jittered-positions", "measure off the grid on which the positions lie", jittered_positions) \
  ENTRY("opposite-approach", "approach the same positions from the other side", opposite_approaches) \
  ENTRY("further-station", "measure from the opposite side of the volume", further_stations)

#define VOLCAL_DECLARE(action, summary, make) \
  std::vector<ExtraMeasurement> make(const CandidateContext& context);
#define VOLCAL_ENTRY(action, summary, make) CandidateKind{action, summary, make},
VOLCAL_CANDIDATES(VOLCAL_DECLARE)

std::span<const CandidateKind> candidate_kinds() {
  static constexpr auto kEntries = std::to_array<CandidateKind>({VOLCAL_CANDIDATES(VOLCAL_ENTRY)});
  return kEntries;
}

std::size_t ExtraMeasurement::readings() const {
  std::size_t count = 0;
  for (const Setup& each : setups) count += each.readings.size();
  return count;
}

std::vector<ExtraMeasurement> candidate_measurements(const CandidateContext& context) {
  std::vector<ExtraMeasurement> all;
  for (const CandidateKind& entry : candidate_kinds()) {
    std::vector<ExtraMeasurement> made = entry.make(context);
    for (ExtraMeasurement& each : made) each.action = entry.action;
    std::ranges::move(made, std::back_inserter(all));
  }
  return all;
}

}  // namespace volcal
