#pragma once
/// What makes readings wrong beyond independent noise: correlated drift, offsets of lines, outliers. Each has
/// a random stream of its own per setup and component, so that adding one leaves everything else as it was.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "volcal/sim/measurement/setup_plan.h"

namespace volcal::sim {

/// Components of a reading in this setup that err independently; of a single contact one, along its normal.
std::size_t channels_of(const SetupPlan& plan);

/// Correlated and gross errors of a planned setup, row by row. Correlated drift is an exactly discretised
/// Ornstein-Uhlenbeck process, x' = -x / tau + white noise (Uhlenbeck and Ornstein 1930), in its steady state
/// from the first reading on.
class CorrelatedNoise {
 public:
  CorrelatedNoise(const SetupPlan& plan, std::uint64_t seed);

  /// Correlated drift and line offset, m or rad; 0 for the angles of a tracker.
  double slow(std::size_t row, std::size_t channel) const;
  /// -1, 0 (as a rule) or +1.
  int outlier(std::size_t row, std::size_t channel) const;

 private:
  std::vector<std::vector<double>> slow_;  ///< [channel][row]; empty when there is none
  std::vector<std::vector<std::int8_t>> outlier_;
};

}  // namespace volcal::sim
