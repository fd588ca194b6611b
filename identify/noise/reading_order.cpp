#include "volcal/identify/noise/reading_order.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace volcal {
namespace {

constexpr std::size_t kLeastLines = 4;

}  // namespace

TimeScale time_scale(const NoiseData& data) {
  TimeScale scale;
  std::vector<double> gaps;
  for (const NoiseSequence& sequence : data.sequences) {
    std::vector<double> time = sequence.time;
    std::ranges::sort(time);
    if (time.size() < 2) continue;
    scale.longest = std::max(scale.longest, time.back() - time.front());
    for (std::size_t i = 1; i < time.size(); ++i) {
      if (time[i] > time[i - 1]) gaps.push_back(time[i] - time[i - 1]);
    }
  }
  if (gaps.empty()) return {};
  std::ranges::nth_element(gaps, gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2));
  scale.usual_gap = gaps[gaps.size() / 2];
  return scale;
}

bool has_lines(const NoiseData& data) {
  std::size_t useful = 0;
  for (const NoiseSequence& sequence : data.sequences) {
    std::map<std::int32_t, std::size_t> readings;
    for (const std::int32_t line : sequence.line) ++readings[line];
    useful += static_cast<std::size_t>(
        std::ranges::count_if(readings, [](const auto& entry) { return entry.second > 1; }));
  }
  return useful >= kLeastLines;
}

double half_squared_difference(const NoiseData& data, const std::vector<std::int64_t>& point,
                               const Eigen::VectorXd& residual) {
  double successive = 0.0, returning = 0.0;
  std::size_t successions = 0, returns = 0;
  for (const NoiseSequence& sequence : data.sequences) {
    std::vector<std::size_t> order(sequence.observation.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    if (!sequence.time.empty()) {
      std::ranges::stable_sort(order, {}, [&](std::size_t k) { return sequence.time[k]; });
    }
    std::map<std::int64_t, double> last;
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::size_t observation = sequence.observation[order[i]];
      const double now = residual(static_cast<Eigen::Index>(observation));
      if (i > 0) {
        const std::size_t before = sequence.observation[order[i - 1]];
        successive += std::pow(now - residual(static_cast<Eigen::Index>(before)), 2);
        ++successions;
      }
      if (point.empty() || point[observation] < 0) continue;
      const auto visited = last.find(point[observation]);
      if (visited != last.end()) {
        returning += std::pow(now - visited->second, 2);
        ++returns;
      }
      last[point[observation]] = now;
    }
  }
  if (returns >= kLeastObservations) return 0.5 * returning / static_cast<double>(returns);
  return successions > 0 ? 0.5 * successive / static_cast<double>(successions) : 0.0;
}

}  // namespace volcal
