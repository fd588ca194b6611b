#include "volcal/identify/standards/iso230_3.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace volcal {
namespace {

constexpr double kHour = 3600.0;

/// Range of the readings from `first` on, within `duration`; they ascend in time.
double range_within(const std::vector<DriftReading>& readings, std::size_t first, double duration) {
  double low = readings[first].value, high = low;
  for (std::size_t k = first; k < readings.size() && readings[k].time <= readings[first].time + duration;
       ++k) {
    low = std::min(low, readings[k].value);
    high = std::max(high, readings[k].value);
  }
  return high - low;
}

}  // namespace

DriftFigures drift_figures(std::span<const DriftReading> readings) {
  DriftFigures figures;
  if (readings.size() < 2) return figures;
  std::vector<DriftReading> ordered(readings.begin(), readings.end());
  std::ranges::stable_sort(ordered, {}, &DriftReading::time);
  figures.duration = ordered.back().time - ordered.front().time;
  figures.range = range_within(ordered, 0, figures.duration);
  figures.change = ordered.back().value - ordered.front().value;
  if (figures.duration < kHour) return figures;
  figures.first_hour = range_within(ordered, 0, kHour);
  double fastest = 0.0;
  for (std::size_t k = 0; k < ordered.size(); ++k)
    fastest = std::max(fastest, range_within(ordered, k, kHour));
  figures.fastest_in_an_hour = fastest;
  return figures;
}

}  // namespace volcal
