#pragma once
/// What the noise model may have absorbed, tested jointly with it. Correlated drift can follow whatever
/// changes along the path of the readings; noise that was estimated without an effect may hold it, and leave
/// nothing to be tested.
///
/// In: a tested model state at which nothing exceeds the noise. Out: the effect that does when the noise
/// is estimated jointly with it. SI; log10 p.
///
/// Likelihood ratio 2 [max l(y - G a) - max l(y)] of restricted likelihoods, each at its own noise. The
/// columns of the model are the same in both and G a is data, so that they can be compared
/// (restricted_likelihood.h); l(y) is the largest found, from the noise of the joint estimate as from its
/// own, since it has several maxima. It is judged by F with the amplitudes and the degrees of freedom that
/// the noise without the effect leaves (noise_freedom.h; Kenward and Roger 1997, Biometrics 53, 983): a drift
/// of seconds is known from a ball-bar's hundred correlation times, one of ten minutes from the few that a
/// run spans.

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "volcal/identify/criticism/search/model_state.h"

namespace volcal {

/// Noise at which effects may exceed: at a given noise l(y - G a) is at most l(y) + LM / 2, so that LM -
/// loss is a lower bound of the likelihood ratio.
struct NoiseAlternative {
  std::vector<NoiseParameters> noise;
  double loss = 0.0;  ///< 2 (l - l here)
};

/// A problem and its likelihood, whose information all hypotheses share: what they move changes the residuals
/// alone.
class JointLikelihood {
 public:
  JointLikelihood(NoiseProblem problem, int threads) : problem_(std::move(problem)), threads_(threads) {}

  const NoiseProblem& problem() const { return problem_; }
  /// Of the residuals less what a hypothesis moves.
  RestrictedLikelihood& without(const Eigen::VectorXd& moved);
  /// Of the residuals as they are.
  RestrictedLikelihood& whole();

 private:
  NoiseProblem problem_;
  int threads_;
  std::unique_ptr<RestrictedLikelihood> likelihood_;  ///< once it is asked for
  bool is_whole_ = true;
};

/// One per instrument that drifts, the others as they are: with so little of its drift left that it holds
/// hardly any effect.
std::vector<NoiseAlternative> noise_with_reduced_drift(JointLikelihood& likelihood,
                                                       const NoiseEstimate& estimate);

struct LikelihoodRatio {
  double value = 0.0;
  double freedom = std::numeric_limits<double>::infinity();  ///< of the noise that it stands on
};

/// `moved`: what a hypothesis moves the readings by, from whatever noise it was found with: another lower
/// bound. `estimate`: for the residuals of `likelihood` as they are. A ratio below `least_ratio` is an upper
/// bound, without its freedom: of the maximum next to the noise of `estimate`, and
/// Thresholds::another_maximum more, where that is enough.
LikelihoodRatio joint_likelihood_ratio(const LinearModel& model, const Eigen::VectorXd& moved,
                                       JointLikelihood& likelihood, const NoiseEstimate& estimate,
                                       const NoiseOptions& options, double least_ratio);

/// Sets LM to the likelihood ratio and log10 p by it; the multiplicity of scanned shapes counts. The
/// amplitude stays that of `test`.
void test_jointly(const LinearModel& model, const Family& family, JointLikelihood& likelihood,
                  const NoiseEstimate& estimate, const NoiseOptions& options, double least_ratio,
                  FamilyTest& test);

class JointNoiseTest {
 public:
  /// `state` is tested, and outlives the object.
  explicit JointNoiseTest(const ModelState& state);

  /// The least probable effect, of those that may be added, where it exceeds the noise.
  std::optional<FamilyTest> effect(const std::function<bool(const FamilyTest&)>& may_be_added) const;

 private:
  std::vector<FamilyTest> absorbed_effects(const std::function<bool(const FamilyTest&)>& may_be_added) const;
  std::vector<FamilyTest> doubtful_effects(const std::function<bool(const FamilyTest&)>& may_be_added) const;
  std::vector<NoiseAlternative> alternatives() const;

  const ModelState& state_;
  std::unique_ptr<JointLikelihood> likelihood_;  ///< its residuals change and return
};

}  // namespace volcal
