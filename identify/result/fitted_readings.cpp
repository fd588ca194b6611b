#include "volcal/identify/result/fitted_readings.h"

#include <fmt/format.h>

#include <algorithm>

#include "volcal/identify/numeric/content_hash.h"

namespace volcal {
namespace {

std::uint64_t hash_of_row(const Setup& setup, std::size_t row) {
  ContentHash hash;
  hash.add(std::string_view(setup.instrument));
  for (const std::vector<double>& position : setup.readings.position) {
    if (!position.empty()) hash.add(position[row] + 0.0);  // -0 is 0
  }
  for (const std::vector<double>& value : setup.readings.value) hash.add(value[row] + 0.0);
  return hash.value();
}

std::size_t readings_in_use(const Setup& setup) {
  return static_cast<std::size_t>(std::ranges::count(setup.rows_left_out(), false));
}

}  // namespace

std::string readings_fingerprint(const Setup& setup) {
  if (readings_in_use(setup) == 0) return {};
  const std::vector<bool> left_out = setup.rows_left_out();
  std::uint64_t sum = 0;
  for (std::size_t row = 0; row < setup.readings.size(); ++row) {
    if (!left_out[row]) sum += hash_of_row(setup, row);
  }
  return fmt::format("{:016x}", sum);
}

FittedReadings fitted_readings(const Campaign& campaign, const FitResult& result) {
  FittedReadings fitted;
  fitted.is_known = std::ranges::any_of(result.setups,
                                        [](const SetupSummary& setup) { return !setup.fingerprint.empty(); });
  for (const Setup& setup : campaign.setups) {
    const std::size_t readings = readings_in_use(setup);
    fitted.all += readings;
    const std::string own = readings_fingerprint(setup);
    if (own.empty() ||
        std::ranges::find(result.setups, own, &SetupSummary::fingerprint) == result.setups.end())
      continue;
    fitted.setups.push_back(setup.name);
    fitted.readings += readings;
  }
  return fitted;
}

}  // namespace volcal
