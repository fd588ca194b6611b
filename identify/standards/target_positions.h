#pragma once
/// Which recorded positions were one target: readings repeat a commanded position, and some controls record
/// where the axis stood instead of where it was sent.

#include <cstddef>
#include <span>
#include <vector>

namespace volcal {

/// Positions farther apart than this (m or rad) are never taken as one target.
inline constexpr double kLargestTargetSpread = 0.1e-3;

struct TargetGroups {
  std::vector<std::size_t> group;  ///< [position]; groups ascend
  std::vector<double> position;    ///< [group], mean
  double spread = 0.0;             ///< largest range of one group
};

/// Positions within `tolerance` above the first of a group share one target. Where the positions fall into
/// clusters, at least ten times farther apart than each is wide, every cluster is one target, as long as none
/// is wider than `kLargestTargetSpread`.
TargetGroups group_targets(std::span<const double> positions, double tolerance);

}  // namespace volcal
