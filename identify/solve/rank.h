#pragma once
/// What the data can determine, found before any covariance is asked for.
///
/// Every error gets a very wide prior (1 mm, 1 mrad over the travel and of squareness, each wider by as much
/// as the readings are noisier than 2 um or 2 urad, or what the model states; nuisance parameters 1 m, 1
/// rad). A direction of the parameter space is invisible when the data improve that prior by less than a
/// factor of ten in standard uncertainty. An error is not visible when the mean of its posterior variance
/// over the measured travel is more than a hundredth of its prior variance. Both are free of the choice of
/// units, and of the noise where this is more than 2 um.
///
/// Surfaces (surface_prior.h) count as known here: what they could hide of an error belongs to the error.
///
/// This holds functions rough between the positions of the readings by 0.1 mm or rad. Where readings tell
/// how rough a function is, what it may do between its positions, given how it deviates from a straight line
/// at them, is three times as rough at most, and an error that the first analysis takes for invisible is
/// judged by this (judge_by_roughness): a squareness from a grid of positions is what the grid says, for all
/// that a straightness might do between its lines.
///
/// Where an error is not visible the prior stands on the invisible directions alone and pulls nothing that
/// the readings determine. Where all are, it also stands, for the detail that smoothing holds, on directions
/// that the readings determine, and changes their estimates by less than a hundredth of u.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/normals/datum.h"
#include "volcal/identify/solve/normals/minimise.h"
#include "volcal/identify/solve/priors/smoothing.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

/// Wide prior on everything, reduced coordinates; keeps an invisible direction at zero with a stated, useless
/// uncertainty instead of letting it take any value. `sigma`: stated, of all readings.
GaussianPrior wide_prior(const MeasurementModel& model, const DatumSpace& datum, const Eigen::VectorXd& z,
                         const std::vector<double>& sigma);

/// The wide prior where `data`, the normal matrix of the readings, leaves a factor above rounding beside it.
/// Where two parameters are one to every reading, as the place of a sphere and the zero of the sensors along
/// the axis that it turns about, a prior of a metre drowns in the rounding of precise readings: then every
/// parameter is held to 1e-12 of its own information or more, mm where the prior was a metre.
GaussianPrior above_rounding(const Eigen::MatrixXd& data, GaussianPrior wide);

/// Priors that the files, or an instrument's weak default, give to the blocks' parameters, and the
/// conventions of rotary axes (rotary_gauge.h); none elsewhere.
GaussianPrior stated_priors(const MeasurementModel& model, const DatumSpace& datum);

struct RankAnalysis {
  RankReport report;
  std::vector<ErrorSymbol> invisible_functions;
  bool deficient = false;        ///< an error is not visible
  Eigen::MatrixXd on_invisible;  ///< precision of the wide prior on the invisible directions alone
  std::vector<int>
      of_surfaces;  ///< reduced coordinates of surfaces' coefficients, which no analysis concerns
};

/// `data`: normal matrix of the readings plus the user's priors on nuisance parameters, reduced coordinates.
RankAnalysis analyse_rank(const MeasurementModel& model, const DatumSpace& datum, const Eigen::MatrixXd& data,
                          const GaussianPrior& wide);

/// The analysis, for where it finds errors not visible, with functions no rougher between the positions of
/// the readings than `terms` allow, of which these determine four coefficients or more beyond the straight
/// part. What the adjustment holds stays that of `rank`.
RankAnalysis judge_by_roughness(const MeasurementModel& model, const DatumSpace& datum,
                                const Eigen::MatrixXd& data, const GaussianPrior& wide,
                                const std::vector<SmoothingTerm>& terms, const RankAnalysis& rank);

/// What an adjustment needs where the readings do not determine everything: adds the wide prior to `prior`,
/// its mean where there was none.
void hold_undetermined(const RankAnalysis& rank, const GaussianPrior& wide, GaussianPrior& prior);
/// Takes the functions that are not visible out of `terms`; they enter `prior` with a stated roughness, since
/// nothing tells it.
void hold_invisible(const RankAnalysis& rank, std::vector<SmoothingTerm>& terms, GaussianPrior& prior);

}  // namespace volcal
