#include "volcal/identify/report/values/budget_shares.h"

#include <algorithm>
#include <cmath>

namespace volcal {
namespace {

/// Mean variance of a line by source.
Eigen::RowVectorXd mean_variance(const UncertaintyBudget& budget, const std::vector<std::size_t>& values) {
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(budget.u.cols());
  for (const std::size_t i : values) sum += budget.u.row(static_cast<Eigen::Index>(i)).cwiseAbs2();
  return sum / static_cast<double>(values.size());
}

}  // namespace

BudgetShares::BudgetShares(const MonteCarloResult& result) : groups(quantity_groups(result)) {
  std::erase_if(groups, [&](const QuantityGroup& group) {
    return result.quantities[group.values.front()].quantity.kind == QuantityKind::Parameter;
  });
  share_.resize(static_cast<Eigen::Index>(groups.size()), result.budget.u.cols());
  for (const QuantityGroup& group : groups) {
    const Eigen::RowVectorXd variance = mean_variance(result.budget, group.values);
    const double sum = variance.sum();
    share_.row(static_cast<Eigen::Index>(u.size())) = variance / (sum > 0.0 ? sum : 1.0);
    u.push_back(std::sqrt(sum));
  }
  for (std::size_t source = 0; source < result.budget.sources.size(); ++source) {
    const auto column = share_.col(static_cast<Eigen::Index>(source));
    if (column.size() > 0 && column.maxCoeff() >= kWorthAColumn) sources.push_back(source);
  }
  std::ranges::stable_sort(sources, [&](std::size_t a, std::size_t b) {
    return share_.col(static_cast<Eigen::Index>(a)).sum() > share_.col(static_cast<Eigen::Index>(b)).sum();
  });
}

double volume_u(const MonteCarloResult& result, const Eigen::VectorXd& u) {
  double squares = 0.0, points = 0.0;
  for (std::size_t i = 0; i < result.quantities.size(); ++i) {
    if (result.quantities[i].quantity.kind != QuantityKind::VolumetricError) continue;
    squares += u[static_cast<Eigen::Index>(i)] * u[static_cast<Eigen::Index>(i)];
    points += 1.0;
  }
  return points > 0.0 ? std::sqrt(squares / points) : 0.0;
}

}  // namespace volcal
