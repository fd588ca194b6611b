#include "volcal/identify/standards/iso230_2.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "volcal/identify/standards/target_positions.h"

namespace volcal {
namespace {

/// Least and largest of what it was given.
class Range {
 public:
  void include(double value) {
    low_ = count_ == 0 ? value : std::min(low_, value);
    high_ = count_ == 0 ? value : std::max(high_, value);
    ++count_;
  }
  void include(double low, double high) {
    include(low);
    include(high);
  }
  std::optional<double> width() const { return count_ == 0 ? std::nullopt : std::optional(high_ - low_); }

 private:
  int count_ = 0;
  double low_ = 0.0;
  double high_ = 0.0;
};

ApproachStatistics statistics(const std::vector<double>& deviations) {
  ApproachStatistics result;
  result.count = static_cast<int>(deviations.size());
  if (deviations.empty()) return result;
  double sum = 0.0;
  for (const double deviation : deviations) sum += deviation;
  result.mean = sum / result.count;
  if (result.count < 2) return result;
  double squares = 0.0;
  for (const double deviation : deviations) squares += (deviation - result.mean) * (deviation - result.mean);
  result.deviation_s = std::sqrt(squares / (result.count - 1));
  return result;
}

void set_targets(const std::vector<PositioningReading>& readings, double tolerance,
                 PositioningFigures& figures) {
  std::vector<double> position;
  for (const PositioningReading& reading : readings) position.push_back(reading.target);
  const TargetGroups groups = group_targets(position, tolerance);
  std::vector<std::vector<double>> positive(groups.position.size()), negative(groups.position.size());
  for (std::size_t k = 0; k < readings.size(); ++k) {
    auto& approaches = readings[k].direction > 0 ? positive : negative;
    approaches[groups.group[k]].push_back(readings[k].deviation);
  }
  for (std::size_t g = 0; g < groups.position.size(); ++g)
    figures.targets.push_back({groups.position[g], statistics(positive[g]), statistics(negative[g])});
  figures.target_spread = groups.spread;
}

UnidirectionalFigures unidirectional(const std::vector<PositioningTarget>& targets,
                                     ApproachStatistics PositioningTarget::*approach) {
  Range means, limits;
  double largest_s = 0.0;
  bool every_s = true;
  for (const auto& target : targets) {
    const ApproachStatistics& at = target.*approach;
    if (at.count == 0) continue;
    means.include(at.mean);
    every_s = every_s && at.deviation_s.has_value();
    const double s = at.deviation_s.value_or(0.0);
    limits.include(at.mean - 2.0 * s, at.mean + 2.0 * s);
    largest_s = std::max(largest_s, s);
  }
  UnidirectionalFigures figures;
  figures.systematic = means.width();
  if (figures.systematic && every_s) {
    figures.repeatability = 4.0 * largest_s;
    figures.accuracy = limits.width();
  }
  return figures;
}

void set_reversal_figures(PositioningFigures& figures) {
  Range means;
  double sum = 0.0, largest = 0.0;
  int count = 0;
  for (const auto& target : figures.targets) {
    if (!target.bidirectional()) continue;
    means.include(*target.mean_bidirectional());
    sum += *target.reversal();
    largest = std::max(largest, std::abs(*target.reversal()));
    ++count;
  }
  if (count == 0) return;
  figures.mean_bidirectional = means.width();
  figures.reversal = largest;
  figures.mean_reversal = sum / count;
}

void set_bidirectional_figures(PositioningFigures& figures) {
  if (!figures.positive.systematic || !figures.negative.systematic) return;
  Range means, limits;
  for (const auto& target : figures.targets) {
    for (const ApproachStatistics* approach : {&target.positive, &target.negative}) {
      if (approach->count == 0) continue;
      means.include(approach->mean);
      const double s = approach->deviation_s.value_or(0.0);
      limits.include(approach->mean - 2.0 * s, approach->mean + 2.0 * s);
    }
  }
  figures.systematic = means.width();
  if (!figures.positive.accuracy || !figures.negative.accuracy) return;
  figures.accuracy = limits.width();
  if (!figures.reversal) return;
  double largest = std::max(*figures.positive.repeatability, *figures.negative.repeatability);
  for (const auto& target : figures.targets) {
    if (target.bidirectional()) largest = std::max(largest, *target.repeatability());
  }
  figures.repeatability = largest;
}

}  // namespace

std::optional<double> PositioningTarget::reversal() const {
  if (!bidirectional()) return std::nullopt;
  return positive.mean - negative.mean;
}

std::optional<double> PositioningTarget::mean_bidirectional() const {
  if (!bidirectional()) return std::nullopt;
  return (positive.mean + negative.mean) / 2.0;
}

std::optional<double> PositioningTarget::repeatability() const {
  if (!positive.deviation_s || !negative.deviation_s) return std::nullopt;
  const double s_plus = *positive.deviation_s, s_minus = *negative.deviation_s;
  return std::max({2.0 * s_plus + 2.0 * s_minus + std::abs(*reversal()), 4.0 * s_plus, 4.0 * s_minus});
}

PositioningFigures positioning_figures(std::span<const PositioningReading> readings,
                                       double target_tolerance) {
  std::vector<PositioningReading> known;
  std::copy_if(readings.begin(), readings.end(), std::back_inserter(known),
               [](const PositioningReading& reading) { return reading.direction != 0; });
  PositioningFigures figures;
  figures.unknown_direction = static_cast<int>(readings.size() - known.size());
  set_targets(known, target_tolerance, figures);
  figures.positive = unidirectional(figures.targets, &PositioningTarget::positive);
  figures.negative = unidirectional(figures.targets, &PositioningTarget::negative);
  set_reversal_figures(figures);
  set_bidirectional_figures(figures);
  return figures;
}

}  // namespace volcal
