// Positions on a grid hide every error whose period divides the grid step.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "volcal/identify/criticism/proposals/candidates/hypothetical_readings.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kSamePosition = 0.02;    // of the mean gap between positions that differ
constexpr double kSameGap = 0.02;         // of a gap
constexpr double kReadBack = 1e-6;        // m
constexpr double kReadingsPerStep = 3.0;  // on a grid every position is met at least so often
constexpr double kReach = 0.4;            // of a grid step, to either side

/// Sorted values that differ by more than `apart`, each the first of its group.
std::vector<double> distinct_values(const std::vector<double>& sorted, double apart) {
  std::vector<double> distinct;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i == 0 || sorted[i] - sorted[i - 1] > apart) distinct.push_back(sorted[i]);
  }
  return distinct;
}

/// Positions that were met, those as one that differ by little beside the others, as where a control reads
/// back 100.001 mm once and 100 mm once.
std::vector<double> met_positions(std::vector<double> positions) {
  std::ranges::sort(positions);
  const std::vector<double> all = distinct_values(positions, kReadBack);
  if (all.size() < 2) return all;
  const double mean_gap = (all.back() - all.front()) / static_cast<double>(all.size() - 1);
  return distinct_values(all, std::max(kReadBack, kSamePosition * mean_gap));
}

/// The gap that most neighbours share; of several the smallest.
double common_gap(const std::vector<double>& positions) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < positions.size(); ++i) gaps.push_back(positions[i] - positions[i - 1]);
  std::ranges::sort(gaps);
  std::span<const double> same;
  for (const double gap : gaps) {
    const auto first = std::ranges::lower_bound(gaps, (1.0 - kSameGap) * gap);
    const auto last = std::ranges::upper_bound(gaps, (1.0 + kSameGap) * gap);
    if (static_cast<std::size_t>(last - first) > same.size()) same = {first, last};
  }
  return std::accumulate(same.begin(), same.end(), 0.0) / static_cast<double>(same.size());
}

/// Step of the grid on which the positions of an axis lie; 0 = on none.
double grid_step(const std::vector<double>& positions) {
  const std::vector<double> met = met_positions(positions);
  if (met.size() < 3) return 0.0;
  if (kReadingsPerStep * static_cast<double>(met.size()) > static_cast<double>(positions.size())) return 0.0;
  return common_gap(met);
}

/// Moves every position of an axis by its own share of the step, inside the travel.
void jitter(const Axis& axis, double step, std::size_t stream, std::vector<double>& positions) {
  for (std::size_t row = 0; row < positions.size(); ++row) {
    const double share = std::fmod(static_cast<double>(row + 17 * stream + 1) * kGoldenShare, 1.0);
    const double moved = positions[row] + (2.0 * share - 1.0) * kReach * step;
    const double mirrored = positions[row] - (moved - positions[row]);
    const bool inside = moved >= axis.travel_min && moved <= axis.travel_max;
    positions[row] = std::clamp(inside ? moved : mirrored, axis.travel_min, axis.travel_max);
  }
}

}  // namespace

std::vector<ExtraMeasurement> jittered_positions(const CandidateContext& context) {
  const auto alter = [](const Setup& measured, const Axis& axis, Readings& again) -> std::string {
    const std::size_t k = index_of(axis.name);
    const double step = is_rotary(axis.name) ? 0.0 : grid_step(measured.readings.position[k]);
    if (step == 0.0) return {};
    jitter(axis, step, k, again.position[k]);
    return fmt::format("{} off its step of {:.4g} mm", letter_of(axis.name), step * kPerMilli);
  };
  return altered_again(context, " off the grid", alter,
                       [](const std::string& place, const std::string& axes) {
                         return fmt::format("measure {} at jittered positions ({})", place, axes);
                       });
}

}  // namespace volcal
