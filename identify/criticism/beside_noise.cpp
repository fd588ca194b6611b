#include "volcal/identify/criticism/beside_noise.h"

#include <algorithm>
#include <cmath>

#include "volcal/identify/stats/chi_squared.h"

namespace volcal {

std::vector<NoiseAlternative> noise_without_wander(const NoiseProblem& problem, const NoiseEstimate& estimate,
                                                   int threads) {
  const std::vector<NoiseParameters> wandering = estimate.parameters();
  const auto wanders = [](const NoiseParameters& noise) { return noise.wander > 0.0; };
  if (std::ranges::none_of(wandering, wanders)) return {};
  NoiseOptions options;
  options.threads = threads;
  options.uncertainty = false;
  options.wander = false;
  const std::vector<NoiseParameters> still = estimate_noise(problem, options).parameters();
  RestrictedLikelihood likelihood(problem, threads);
  std::vector<NoiseAlternative> alternatives;
  for (std::size_t group = 0; group < wandering.size(); ++group) {
    if (!wanders(wandering[group])) continue;
    std::vector<NoiseParameters> noise = wandering;
    noise[group] = still[group];
    const double loss = 2.0 * (estimate.log_likelihood - likelihood.log_likelihood(noise));
    alternatives.push_back({std::move(noise), loss});
  }
  return alternatives;
}

namespace {

/// Whether readings of a group are moved, per group.
std::vector<bool> moved_groups(const NoiseData& data, const Eigen::VectorXd& moved, std::size_t groups) {
  std::vector<bool> is_moved(groups, false);
  for (const NoiseSequence& sequence : data.sequences) {
    if (std::ranges::any_of(sequence.observation,
                            [&](std::size_t row) { return moved[static_cast<Eigen::Index>(row)] != 0.0; })) {
      is_moved[sequence.group] = true;
    }
  }
  return is_moved;
}

/// Those that the groups counted have, under either estimate.
int noise_parameters(const NoiseEstimate& one, const NoiseEstimate& other, const std::vector<bool>& counted) {
  int count = 0;
  for (std::size_t group = 0; group < counted.size(); ++group) {
    if (!counted[group]) continue;
    const InstrumentNoise &a = one.instruments[group], &b = other.instruments[group];
    count += 1 + (a.wander.on || b.wander.on ? 2 : 0) + (a.line.on || b.line.on ? 1 : 0) +
             (a.per_metre.on || b.per_metre.on ? 1 : 0);
  }
  return count;
}

}  // namespace

void test_beside_noise(const LinearModel& model, const Family& family, NoiseProblem problem,
                       const NoiseEstimate& estimate, int threads, FamilyTest& test) {
  const Eigen::VectorXd moved = family_columns(model, family, test.shape) * test.score.amplitude;
  NoiseOptions options;
  options.threads = threads;
  options.uncertainty = false;
  problem.residual -= moved;
  const NoiseEstimate beside = estimate_noise(problem, options, &estimate);
  problem.residual += moved;
  const NoiseEstimate alone = estimate_noise(problem, options, &beside);
  const double without = std::max(estimate.log_likelihood, alone.log_likelihood);
  test.score.lm = std::max(0.0, 2.0 * (beside.log_likelihood - without));
  const int beside_it =
      noise_parameters(alone, beside, moved_groups(problem.data, moved, beside.instruments.size()));
  test.score.log10_p = log10_chi_squared_exceedance(test.score.lm, test.score.dof + beside_it);
  test.log10_p = std::min(0.0, test.score.log10_p + std::log10(test.multiplicity));
}

}  // namespace volcal
