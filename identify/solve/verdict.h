#pragma once
/// What is reported of a finished adjustment.

#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

struct AdjustmentEnd {
  bool converged = true;
  bool rank_deficient = false;  ///< an error that the model has is not visible
};

/// A stated value that the readings contradict is a mistake in a file, or a model that lacks something.
/// `more_u`: standard uncertainties of the parameters beside those of their priors; empty = none.
std::vector<Finding> contradicted_priors(const std::vector<ParameterBlock>& blocks,
                                         const Eigen::VectorXd& parameters,
                                         const Eigen::VectorXd& more_u = {});

/// Sets status and appends findings: stated sigma that is wrong, noise that is more than white, what is not
/// visible, outliers, stated guesses that are contradicted, stations in the plane of a machine of two linear
/// axes, drivers that were not recorded, lack of fit.
void judge(const MeasurementModel& model, const AdjustmentEnd& end, FitResult& result);

}  // namespace volcal
