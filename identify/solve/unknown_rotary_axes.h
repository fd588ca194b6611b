#pragma once
/// Rotary axes that move in readings and of which a model has no errors: how large these may be, as wide as
/// the prior of what a fit does not see (rank.h), for the uncertainty of what the model predicts there.

#include <Eigen/Core>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

/// The model with the error motions and locations of these axes, all without values, as fine as the readings
/// allow.
ModelSpec with_unknown_errors(const Campaign& campaign, ModelSpec model, const std::vector<AxisName>& axes);

/// Covariance before any reading of the errors of these axes, raw parameters of a model that has them, SI;
/// zero of all others. `sigma`: stated, of all readings.
Eigen::MatrixXd covariance_of_unknown_errors(const MeasurementModel& model, const std::vector<AxisName>& axes,
                                             const Eigen::VectorXd& parameters,
                                             const std::vector<double>& sigma);

}  // namespace volcal
