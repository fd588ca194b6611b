#include "volcal/identify/criticism/search/joint_noise.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include "volcal/identify/criticism/catalogue/shape_refinement.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/projection/noise_freedom.h"
#include "volcal/identify/criticism/projection/score_statistics.h"
#include "volcal/identify/statistics/chi_squared.h"

namespace volcal {
namespace {

void keep_best(std::vector<FamilyTest>& tests) {
  std::ranges::sort(tests, std::greater{}, &FamilyTest::gain);
  if (tests.size() > kThresholds.most_joint_tests) tests.resize(kThresholds.most_joint_tests);
}

}  // namespace

RestrictedLikelihood& JointLikelihood::without(const Eigen::VectorXd& moved) {
  if (!likelihood_) whole();
  Eigen::VectorXd whole = problem_.residual;
  problem_.residual -= moved;
  likelihood_->set_residual(problem_);
  problem_.residual.swap(whole);
  is_whole_ = false;
  return *likelihood_;
}

RestrictedLikelihood& JointLikelihood::whole() {
  if (!likelihood_) likelihood_ = std::make_unique<RestrictedLikelihood>(problem_, threads_);
  if (!is_whole_) likelihood_->set_residual(problem_);
  is_whole_ = true;
  return *likelihood_;
}

std::vector<NoiseAlternative> noise_with_reduced_drift(JointLikelihood& likelihood,
                                                       const NoiseEstimate& estimate) {
  const std::vector<NoiseParameters> drifting = estimate.parameters();
  const auto drifts = [](const NoiseParameters& noise) { return noise.drift > 0.0; };
  if (std::ranges::none_of(drifting, drifts)) return {};
  std::vector<NoiseAlternative> alternatives;
  for (std::size_t group = 0; group < drifting.size(); ++group) {
    if (!drifts(drifting[group])) continue;
    std::vector<NoiseParameters> noise = drifting;
    noise[group].drift *= kThresholds.reduced_drift;
    const double loss = 2.0 * (estimate.log_likelihood - likelihood.whole().log_likelihood(noise));
    alternatives.push_back({std::move(noise), loss});
  }
  return alternatives;
}

LikelihoodRatio joint_likelihood_ratio(const LinearModel& model, const Eigen::VectorXd& moved,
                                       JointLikelihood& likelihood, const NoiseEstimate& estimate,
                                       const NoiseOptions& options, double least_ratio) {
  NoiseOptions plain = options;
  plain.uncertainty = false;
  RestrictedLikelihood& without_effect = likelihood.without(moved);
  LikelihoodRatio test;
  const double nearby = nearby_log_likelihood(without_effect, plain, estimate);
  test.value = std::max(0.0, 2.0 * (nearby - estimate.log_likelihood)) + kThresholds.another_maximum;
  if (test.value < least_ratio) return test;
  const NoiseEstimate jointly = estimate_noise(without_effect, plain, &estimate);
  const auto ratio_to = [&](double without) {
    return std::max(0.0, 2.0 * (jointly.log_likelihood - without));
  };
  test.value = ratio_to(estimate.log_likelihood);
  if (test.value < least_ratio) return test;
  NoiseOptions with_uncertainty = options;
  with_uncertainty.uncertainty = true;
  const NoiseEstimate alone = estimate_noise(likelihood.whole(), with_uncertainty, &jointly);
  test.value = ratio_to(std::max(estimate.log_likelihood, alone.log_likelihood));
  const NoiseProblem& problem = likelihood.problem();
  const auto projector_of = [&](const std::vector<NoiseParameters>& noise) {
    return std::make_unique<Projector>(problem, problem.data, noise, options.threads, model.parts());
  };
  test.freedom = noise_freedom(moved, *projector_of(alone.parameters()), alone, projector_of).front();
  return test;
}

void test_jointly(const LinearModel& model, const Family& family, JointLikelihood& likelihood,
                  const NoiseEstimate& estimate, const NoiseOptions& options, double least_ratio,
                  FamilyTest& test) {
  const auto [ratio, freedom] = joint_likelihood_ratio(model, displacement(model, family, test), likelihood,
                                                       estimate, options, least_ratio);
  test.score.lm = ratio;
  test.score.log10_p = log10_exceedance_of_estimated(test.score.lm, test.score.dof, freedom);
  test.log10_p = std::min(0.0, test.score.log10_p + std::log10(test.multiplicity));
}

JointNoiseTest::JointNoiseTest(const ModelState& state)
    : state_(state),
      likelihood_(std::make_unique<JointLikelihood>(state.problem(), state.setting().threads)) {}

std::vector<NoiseAlternative> JointNoiseTest::alternatives() const {
  return noise_with_reduced_drift(*likelihood_, state_.noise_estimate());
}

/// Effects that would exceed were there hardly any drift: noise that was estimated without an effect can
/// have taken it for one.
std::vector<FamilyTest> JointNoiseTest::absorbed_effects(
    const std::function<bool(const FamilyTest&)>& may_be_added) const {
  const SearchSetting& setting = state_.setting();
  std::vector<FamilyTest> tests;
  for (const NoiseAlternative& other : alternatives()) {
    const auto projector = state_.projector_at(other.noise);
    std::vector<FamilyTest> all =
        test_families(state_.model(), setting.families, *projector, setting.threads);
    std::erase_if(all, [&](const FamilyTest& test) {
      return !may_be_added(test) || test.score.lm < other.loss - kThresholds.worth_joint_estimate;
    });
    std::vector<FamilyTest*> worth;
    for (FamilyTest& test : all) worth.push_back(&test);
    refine_shapes(state_.model(), setting.families, *projector, setting.threads, worth);
    for (FamilyTest& test : all) test.gain -= other.loss;
    std::ranges::move(all, std::back_inserter(tests));
  }
  keep_best(tests);
  return tests;
}

/// Effects above the noise, if it were as well known as that.
std::vector<FamilyTest> JointNoiseTest::doubtful_effects(
    const std::function<bool(const FamilyTest&)>& may_be_added) const {
  std::vector<FamilyTest> tests;
  for (const FamilyTest& test : state_.tests().families) {
    if (may_be_added(test) && state_.setting().exceeds(test)) tests.push_back(test);
  }
  keep_best(tests);
  return tests;
}

std::optional<FamilyTest> JointNoiseTest::effect(
    const std::function<bool(const FamilyTest&)>& may_be_added) const {
  const SearchSetting& setting = state_.setting();
  std::vector<FamilyTest> tests = absorbed_effects(may_be_added);
  std::ranges::move(doubtful_effects(may_be_added), std::back_inserter(tests));
  for (FamilyTest& test : tests) {
    const double least = chi_squared_quantile(setting.log10_level(), test.score.dof);
    test_jointly(state_.model(), setting.families[test.family], *likelihood_, state_.noise_estimate(),
                 state_.noise_options(), least, test);
  }
  const auto best = std::ranges::min_element(tests, {}, &FamilyTest::log10_p);
  if (best == tests.end() || setting.family_wise_log10_p(*best) > log10_family_risk()) return std::nullopt;
  return *best;
}

}  // namespace volcal
