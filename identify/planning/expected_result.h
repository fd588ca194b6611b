#pragma once
/// The result that a fit of a campaign would have before any reading is taken: covariance, rank and
/// observability are those of the adjustment (solve/fit.h) on the nominal machine, values are zero.
///
/// The adjustment is the fit's own: resolution, datum, rank analysis, wide priors on what is not visible,
/// priors of blocks. What only readings tell is assumed: noise is as stated and independent; functions with
/// automatic knots are as rough as the guess says, where the fit finds it by evidence and adds what it does
/// not know of it; the machine's errors are small, so that second order plays no part.

#include <vector>

#include "volcal/identify/planning/plan_settings.h"
#include "volcal/identify/result/result.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {

/// Readings' values play no part. Throws InputError as fit() does. With `adjustment`: linear models of
/// criticism (criticism/projection/linear_model.h) can be made from it.
FitResult expected_result(const Campaign& campaign, const ModelSpec& model,
                          const FunctionRoughnessGuess& roughness, int threads = 0);

/// Root mean square over the volume and the tools of the standard uncertainty of the error vector,
/// sqrt(u_ex^2 + u_ey^2 + u_ez^2), m; and its largest.
struct VolumetricUncertainty {
  double rms = 0.0;
  double largest = 0.0;
};
VolumetricUncertainty volumetric_uncertainty(const FitResult& result, const std::vector<Tool>& tools,
                                             int per_axis);
/// The same over poses, of each tool its own.
VolumetricUncertainty uncertainty_at_poses(const FitResult& result, const std::vector<Tool>& tools,
                                           const std::vector<std::vector<AxisPosition>>& poses);

}  // namespace volcal
