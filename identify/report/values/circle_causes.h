#pragma once
/// Which error of a model makes how much of a circle: every error function, squareness, expansion and effect
/// moves the radius by its own amount round the circle. What a circle that is set up elsewhere or a bar of
/// another length takes up (1, cos and sin of the angle) is no deviation from the circle and is left out.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/identify/standards/standard_figures.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/model_spec.h"

namespace volcal {

struct CircleCause {
  std::string name;               ///< "EXX", "EC0Y", "reversal EXX"
  double range = 0.0;             ///< of the radius over the circle, m
  std::optional<double> range_u;  ///< standard uncertainty, m; empty without a covariance
  double rms = 0.0;               ///< m
  /// <e_c, e> / <e, e> over the circle, e what all causes make together: they sum to 1, and what cancels
  /// others is negative.
  double share = 0.0;
};

/// Per circle, largest share first, whatever its sign; what does not move the radius is left out.
/// `parameters`: of the model on this campaign (evaluate.h). `identified` supplies the covariance when
/// `model` is its identified model.
std::vector<std::vector<CircleCause>> circle_causes(const Campaign& campaign, const ModelSpec& model,
                                                    const Eigen::VectorXd& parameters,
                                                    const FitResult* identified,
                                                    std::span<const CircleTest> circles);

}  // namespace volcal
