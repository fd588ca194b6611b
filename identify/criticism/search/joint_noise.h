#pragma once
/// Test of an effect, or of what a scan has seen, with the noise estimated beside it. A wander can follow
/// whatever changes along the path of the readings; noise that was estimated without an effect may hold it,
/// and leave nothing to be tested.
///
/// Likelihood ratio 2 [max l(y - G a) - max l(y)] of restricted likelihoods, each at its own noise. The
/// columns of the model are the same in both and G a is data, so that they can be compared
/// (restricted_likelihood.h); l(y) is the largest found, from the noise beside the effect as from its own,
/// since it has several maxima. It is judged by F with the amplitudes and the degrees of freedom that the
/// noise without the effect leaves (noise_freedom.h): a wander of seconds is known from a ball-bar's hundred
/// correlation times, one of ten minutes from the few that a run spans.

#include <limits>
#include <vector>

#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/identify/noise/noise_estimate.h"

namespace volcal {

/// Noise at which effects may stand out: at a given noise l(y - G a) is at most l(y) + LM / 2, so that LM -
/// loss is a lower bound of the likelihood ratio.
struct NoiseAlternative {
  std::vector<NoiseParameters> noise;
  double loss = 0.0;  ///< 2 (l - l here)
};

/// One per instrument that wanders, the others as they are: with so little of its wander left that it holds
/// hardly any effect.
std::vector<NoiseAlternative> noise_with_reduced_drift(const NoiseProblem& problem,
                                                       const NoiseEstimate& estimate, int threads);

struct LikelihoodRatio {
  double value = 0.0;
  double freedom = std::numeric_limits<double>::infinity();  ///< of the noise that it stands on
};

/// `moved`: what a hypothesis moves the readings by, from whatever noise it was found with: another lower
/// bound. `estimate`: for `problem`. A ratio below `least_ratio` is an upper bound, without its freedom.
LikelihoodRatio test_jointly(const LinearModel& model, const Eigen::VectorXd& moved, NoiseProblem problem,
                             const NoiseEstimate& estimate, const NoiseOptions& options, double least_ratio);

/// Sets LM to the likelihood ratio and log10 p by it; the multiplicity of scanned shapes counts. The
/// amplitude stays that of `test`.
void test_jointly(const LinearModel& model, const Family& family, NoiseProblem problem,
                  const NoiseEstimate& estimate, const NoiseOptions& options, double least_ratio,
                  FamilyTest& test);

}  // namespace volcal
