#pragma once
/// Readings that no machine gives.

#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

/// `setups` summarise `records`, the residuals of the nominal machine. Throws InputError for a setup that
/// misses it by 2 % of the longest travel: one reading is a blunder, readings are in another unit
/// or another setup's file, or the setup is described wrongly. Names the line of the worst reading.
void require_plausible(const Campaign& campaign, const std::vector<ResidualRecord>& records,
                       const std::vector<SetupSummary>& setups);

/// The same of the fitted machine, once the nominal one is plausible: not the readings are wrong, the
/// adjustment went astray. Names the parameters of effects' shapes, which lead there.
void require_plausible_fit(const MeasurementModel& model, const Eigen::VectorXd& parameters,
                           const std::vector<SetupSummary>& setups);

}  // namespace volcal
