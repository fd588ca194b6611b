// Positions on a grid hide every error whose period divides the grid step.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "volcal/identify/criticism/proposals/candidates/hypothetical_readings.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kSamePosition = 1e-6;    // m
constexpr double kReadingsPerStep = 3.0;  // on a grid every position is met at least so often
constexpr double kReach = 0.4;            // of a grid step, to either side

/// Step of the grid on which the positions of an axis lie; 0 = on none.
double grid_step(const std::vector<double>& positions) {
  std::vector<double> distinct = positions;
  std::ranges::sort(distinct);
  const auto same = [](double a, double b) { return b - a < kSamePosition; };
  distinct.erase(std::unique(distinct.begin(), distinct.end(), same), distinct.end());
  if (distinct.size() < 3) return 0.0;
  if (kReadingsPerStep * static_cast<double>(distinct.size()) > static_cast<double>(positions.size())) {
    return 0.0;
  }
  double step = distinct.back() - distinct.front();
  for (std::size_t i = 1; i < distinct.size(); ++i) step = std::min(step, distinct[i] - distinct[i - 1]);
  return step;
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
