// The same station again, hours later: what drifts with time has moved on, what depends on temperature or
// position has not.
#include <fmt/format.h>

#include "volcal/identify/criticism/proposals/candidates/hypothetical_readings.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

constexpr double kHoursLater = 3.0;
constexpr double kOvernight = 16.0;

std::vector<ExtraMeasurement> again(const CandidateContext& context, double hours, Temperatures temperatures,
                                    const std::string& when) {
  const Campaign& campaign = context.campaign;
  std::vector<ExtraMeasurement> all;
  if (!has_time(campaign)) return all;
  for (const Setup* setup : one_setup_per_station(campaign)) {
    all.push_back(taken_again(context, *setup, setup->name + " again " + when,
                              fmt::format("measure {} again {}", place_and_tool(campaign, *setup), when),
                              hours * kSecondsPerHour, temperatures));
  }
  return all;
}

}  // namespace

std::vector<ExtraMeasurement> revisits(const CandidateContext& context) {
  return again(context, kHoursLater, Temperatures::Last, fmt::format("after {:.0f} h", kHoursLater));
}

std::vector<ExtraMeasurement> cold_starts(const CandidateContext& context) {
  if (temperature_channels(context.campaign).empty()) return {};
  return again(context, kOvernight, Temperatures::First, "the next day, at the temperatures of the start");
}

}  // namespace volcal
