#pragma once
/// An uncertainty budget by lines of quantities: what tables and plots show of it.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/report/values/quantity_groups.h"

namespace volcal {

/// Of table values and volumetric errors; other parameters are left out.
struct BudgetShares {
  static constexpr double kWorthAColumn = 0.01;  ///< of the variance of some line

  explicit BudgetShares(const MonteCarloResult& result);

  std::vector<QuantityGroup> groups;
  std::vector<double> u;             ///< per group: root mean square over its values, SI
  std::vector<std::size_t> sources;  ///< worth a column, the largest first
  /// Of the mean variance of a group, 0..1.
  double of(std::size_t group, std::size_t source) const {
    return share_(static_cast<Eigen::Index>(group), static_cast<Eigen::Index>(source));
  }

 private:
  Eigen::MatrixXd share_;  ///< groups x sources
};

/// Root mean square of the uncertainties `u` (one per quantity, SI) of ex, ey, ez over the points and tools
/// of the volume; 0 without a volume.
double volume_u(const MonteCarloResult& result, const Eigen::VectorXd& u);

}  // namespace volcal
