#include "volcal/identify/standards/target_positions.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

namespace volcal {
namespace {

constexpr double kSeparation = 10.0;  // distance of clusters over their width

/// Gap above which two neighbours belong to different clusters: where the sorted gaps grow most.
std::optional<double> gap_within_clusters(const std::vector<double>& ascending, double tolerance) {
  std::vector<double> gaps;
  for (std::size_t k = 1; k < ascending.size(); ++k)
    gaps.push_back(std::max(ascending[k] - ascending[k - 1], tolerance));
  std::sort(gaps.begin(), gaps.end());
  std::optional<double> within;
  double steepest = kSeparation;
  for (std::size_t k = 1; k < gaps.size() && gaps[k - 1] <= kLargestTargetSpread; ++k) {
    const double growth = gaps[k] / gaps[k - 1];
    if (growth < steepest) continue;
    steepest = growth;
    within = gaps[k - 1];
  }
  return within;
}

/// Index of the first position of every group.
template <class Continues>
std::vector<std::size_t> starts(const std::vector<double>& ascending, Continues continues) {
  std::vector<std::size_t> first;
  for (std::size_t k = 0; k < ascending.size(); ++k) {
    if (first.empty() || !continues(first.back(), k)) first.push_back(k);
  }
  return first;
}

double widest(const std::vector<double>& ascending, const std::vector<std::size_t>& first) {
  double width = 0.0;
  for (std::size_t g = 0; g < first.size(); ++g) {
    const std::size_t end = g + 1 < first.size() ? first[g + 1] : ascending.size();
    width = std::max(width, ascending[end - 1] - ascending[first[g]]);
  }
  return width;
}

bool are_clusters(const std::vector<double>& ascending, const std::vector<std::size_t>& first) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t g = 1; g < first.size(); ++g)
    nearest = std::min(nearest, ascending[first[g]] - ascending[first[g] - 1]);
  const double width = widest(ascending, first);
  return width <= kLargestTargetSpread && nearest >= kSeparation * width;
}

}  // namespace

TargetGroups group_targets(std::span<const double> positions, double tolerance) {
  std::vector<std::size_t> order(positions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return positions[a] < positions[b]; });
  std::vector<double> ascending;
  for (const std::size_t i : order) ascending.push_back(positions[i]);
  std::vector<std::size_t> first = starts(ascending, [&](std::size_t group, std::size_t k) {
    return ascending[k] - ascending[group] <= tolerance;
  });
  if (const auto within = gap_within_clusters(ascending, tolerance)) {
    const std::vector<std::size_t> clusters = starts(
        ascending, [&](std::size_t, std::size_t k) { return ascending[k] - ascending[k - 1] <= *within; });
    if (are_clusters(ascending, clusters)) first = clusters;
  }
  TargetGroups groups;
  groups.group.resize(positions.size());
  groups.spread = widest(ascending, first);
  for (std::size_t g = 0; g < first.size(); ++g) {
    const std::size_t end = g + 1 < first.size() ? first[g + 1] : ascending.size();
    double sum = 0.0;
    for (std::size_t k = first[g]; k < end; ++k) {
      sum += ascending[k];
      groups.group[order[k]] = g;
    }
    groups.position.push_back(sum / static_cast<double>(end - first[g]));
  }
  return groups;
}

}  // namespace volcal
