#include "volcal/identify/montecarlo/uncertainty_budget.h"

namespace volcal {

Eigen::VectorXd UncertaintyBudget::u_with_half_of(std::size_t source) const {
  const Eigen::VectorXd of_source = u.col(static_cast<Eigen::Index>(source)).cwiseAbs2();
  return (u.rowwise().squaredNorm() - 0.75 * of_source).cwiseMax(0.0).cwiseSqrt();
}

UncertaintyBudget uncertainty_budget(const RepeatedCampaign& campaign, const QuantitySet& quantities) {
  const Eigen::MatrixXd rows = campaign.datum().reduce_rows(quantities.rows);
  const std::vector<UncertaintySource>& sources = campaign.uncertainty_sources();
  UncertaintyBudget budget;
  budget.u.resize(rows.rows(), static_cast<Eigen::Index>(sources.size()));
  for (const UncertaintySource& source : sources) {
    budget.u.col(static_cast<Eigen::Index>(budget.sources.size())) = (rows * source.root).rowwise().norm();
    budget.sources.push_back(source.name);
  }
  return budget;
}

}  // namespace volcal
