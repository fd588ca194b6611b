#include "volcal/identify/criticism/search/joint_noise.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/projection/noise_freedom.h"
#include "volcal/identify/stats/chi_squared.h"

namespace volcal {
std::vector<NoiseAlternative> noise_with_reduced_drift(const NoiseProblem& problem,
                                                       const NoiseEstimate& estimate, int threads) {
  const std::vector<NoiseParameters> wandering = estimate.parameters();
  const auto wanders = [](const NoiseParameters& noise) { return noise.wander > 0.0; };
  if (std::ranges::none_of(wandering, wanders)) return {};
  RestrictedLikelihood likelihood(problem, threads);
  std::vector<NoiseAlternative> alternatives;
  for (std::size_t group = 0; group < wandering.size(); ++group) {
    if (!wanders(wandering[group])) continue;
    std::vector<NoiseParameters> noise = wandering;
    noise[group].wander *= kThresholds.reduced_drift;
    const double loss = 2.0 * (estimate.log_likelihood - likelihood.log_likelihood(noise));
    alternatives.push_back({std::move(noise), loss});
  }
  return alternatives;
}

LikelihoodRatio test_jointly(const LinearModel& model, const Eigen::VectorXd& moved, NoiseProblem problem,
                             const NoiseEstimate& estimate, const NoiseOptions& options, double least_ratio) {
  NoiseOptions plain = options;
  plain.uncertainty = false;
  problem.residual -= moved;
  const NoiseEstimate beside = estimate_noise(problem, plain, &estimate);
  problem.residual += moved;
  LikelihoodRatio test;
  const auto ratio_to = [&](double without) {
    return std::max(0.0, 2.0 * (beside.log_likelihood - without));
  };
  test.value = ratio_to(estimate.log_likelihood);
  if (test.value < least_ratio) return test;
  NoiseOptions with_uncertainty = options;
  with_uncertainty.uncertainty = true;
  const NoiseEstimate alone = estimate_noise(problem, with_uncertainty, &beside);
  test.value = ratio_to(std::max(estimate.log_likelihood, alone.log_likelihood));
  const auto projector_of = [&](const std::vector<NoiseParameters>& noise) {
    return std::make_unique<Projector>(problem, problem.data, noise, options.threads, model.parts());
  };
  test.freedom = noise_freedom(moved, *projector_of(alone.parameters()), alone, projector_of).front();
  return test;
}

void test_jointly(const LinearModel& model, const Family& family, NoiseProblem problem,
                  const NoiseEstimate& estimate, const NoiseOptions& options, double least_ratio,
                  FamilyTest& test) {
  const Eigen::VectorXd moved = family_columns(model, family, test.shape) * test.score.amplitude;
  const auto [ratio, freedom] =
      test_jointly(model, moved, std::move(problem), estimate, options, least_ratio);
  test.score.lm = ratio;
  test.score.log10_p = log10_exceedance_of_estimated(test.score.lm, test.score.dof, freedom);
  test.log10_p = std::min(0.0, test.score.log10_p + std::log10(test.multiplicity));
}

}  // namespace volcal
