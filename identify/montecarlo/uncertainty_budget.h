#pragma once
/// Which source contributes what to which uncertainty, by linear propagation (GUM, JCGM 100:2008, 5.1 and
/// appendix H): the noise of every instrument, what is stated of tools, stations and scales, how rough
/// error functions may be between and beside the readings, and disturbances that the fit knows nothing of.
/// Sources are independent; the squares of their contributions add up to u^2.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "volcal/identify/montecarlo/quantities.h"
#include "volcal/identify/montecarlo/repeated_campaign.h"

namespace volcal {

struct UncertaintyBudget {
  std::vector<std::string> sources;  ///< in words
  Eigen::MatrixXd u;                 ///< quantities x sources, SI; of a volume's size, about the estimate

  /// Standard uncertainties if the source's standard deviation were half of what it is and the adjustment
  /// weighted readings as it does; SI.
  Eigen::VectorXd u_with_half_of(std::size_t source) const;
};

UncertaintyBudget uncertainty_budget(const RepeatedCampaign& campaign, const QuantitySet& quantities);

}  // namespace volcal
