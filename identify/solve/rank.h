#pragma once
/// What the data can determine, found before any covariance is asked for.
///
/// Every error gets a very wide prior (1 mm, 1 mrad over the travel and of squareness; nuisance parameters
/// 1 m, 1 rad). A direction of the parameter space is invisible when the data improve that prior by less than
/// a factor of ten in standard uncertainty. An error is not visible when the mean of its posterior variance
/// over the measured travel is more than a hundredth of its prior variance. Both are free of the choice of
/// units.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/solve/datum.h"
#include "volcal/identify/solve/minimise.h"
#include "volcal/identify/solve/result.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

/// Wide prior on everything, reduced coordinates; keeps an invisible direction at zero with a stated, useless
/// uncertainty instead of letting it take any value.
GaussianPrior wide_prior(const MeasurementModel& model, const DatumSpace& datum, const Eigen::VectorXd& z);

struct RankAnalysis {
  RankReport report;
  std::vector<ErrorSymbol> invisible_functions;
  bool deficient = false;  ///< an error is not visible
};

/// `data`: normal matrix of the readings plus the user's priors on nuisance parameters, reduced coordinates.
RankAnalysis analyse_rank(const MeasurementModel& model, const DatumSpace& datum, const Eigen::MatrixXd& data,
                          const GaussianPrior& wide);

}  // namespace volcal
