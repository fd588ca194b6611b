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

std::vector<NoiseAlternative> noise_with_reduced_drift(const NoiseProblem& problem,
                                                       const NoiseEstimate& estimate, int threads) {
  const std::vector<NoiseParameters> drifting = estimate.parameters();
  const auto drifts = [](const NoiseParameters& noise) { return noise.drift > 0.0; };
  if (std::ranges::none_of(drifting, drifts)) return {};
  RestrictedLikelihood likelihood(problem, threads);
  std::vector<NoiseAlternative> alternatives;
  for (std::size_t group = 0; group < drifting.size(); ++group) {
    if (!drifts(drifting[group])) continue;
    std::vector<NoiseParameters> noise = drifting;
    noise[group].drift *= kThresholds.reduced_drift;
    const double loss = 2.0 * (estimate.log_likelihood - likelihood.log_likelihood(noise));
    alternatives.push_back({std::move(noise), loss});
  }
  return alternatives;
}

LikelihoodRatio joint_likelihood_ratio(const LinearModel& model, const Eigen::VectorXd& moved,
                                       NoiseProblem problem, const NoiseEstimate& estimate,
                                       const NoiseOptions& options, double least_ratio) {
  NoiseOptions plain = options;
  plain.uncertainty = false;
  problem.residual -= moved;
  const NoiseEstimate jointly = estimate_noise(problem, plain, &estimate);
  problem.residual += moved;
  LikelihoodRatio test;
  const auto ratio_to = [&](double without) {
    return std::max(0.0, 2.0 * (jointly.log_likelihood - without));
  };
  test.value = ratio_to(estimate.log_likelihood);
  if (test.value < least_ratio) return test;
  NoiseOptions with_uncertainty = options;
  with_uncertainty.uncertainty = true;
  const NoiseEstimate alone = estimate_noise(problem, with_uncertainty, &jointly);
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
  const auto [ratio, freedom] = joint_likelihood_ratio(model, displacement(model, family, test),
                                                       std::move(problem), estimate, options, least_ratio);
  test.score.lm = ratio;
  test.score.log10_p = log10_exceedance_of_estimated(test.score.lm, test.score.dof, freedom);
  test.log10_p = std::min(0.0, test.score.log10_p + std::log10(test.multiplicity));
}

std::vector<NoiseAlternative> JointNoiseTest::alternatives() const {
  return noise_with_reduced_drift(problem_, state_.noise_estimate(), state_.setting().threads);
}

/// Effects that would exceed were there hardly any drift: noise that was estimated without an effect can
/// have taken it for one.
std::vector<FamilyTest> JointNoiseTest::absorbed_effects(
    const std::function<bool(const FamilyTest&)>& may_be_added) const {
  const SearchSetting& setting = state_.setting();
  std::vector<FamilyTest> tests;
  for (const NoiseAlternative& other : alternatives()) {
    const auto projector = state_.projector_at(other.noise);
    for (FamilyTest& test : test_families(state_.model(), setting.families, *projector, setting.threads)) {
      if (!may_be_added(test) || test.score.lm < other.loss - kThresholds.worth_joint_estimate) continue;
      refine_shape(state_.model(), setting.families[test.family], *projector, test);
      test.gain -= other.loss;
      tests.push_back(std::move(test));
    }
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
    test_jointly(state_.model(), setting.families[test.family], problem_, state_.noise_estimate(),
                 state_.noise_options(), least, test);
  }
  const auto best = std::ranges::min_element(tests, {}, &FamilyTest::log10_p);
  if (best == tests.end() || setting.family_wise_log10_p(*best) > log10_family_risk()) return std::nullopt;
  return *best;
}

/// Scans that would exceed were there hardly any drift, the most improbable of each instrument's.
std::vector<JointNoiseTest::AbsorbedScan> JointNoiseTest::absorbed_scans() const {
  struct Candidate {
    std::size_t scan;
    double log10_p;
  };
  const SearchSetting& setting = state_.setting();
  const double log10_scans = state_.tests().log10_scans();
  std::vector<AbsorbedScan> absorbed;
  for (const NoiseAlternative& other : alternatives()) {
    const auto projector = state_.projector_at(other.noise);
    const std::vector<GenericTest> scans =
        generic_scan(state_.model(), setting.variables, *projector, setting.threads);
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const double ratio = scans[i].lm - other.loss + kThresholds.worth_joint_estimate;
      if (!(ratio > 0.0) || scans[i].dof == 0.0) continue;
      const double log10_p = log10_chi_squared_exceedance(ratio, scans[i].dof);
      if (log10_p + log10_scans <= log10_scan_risk()) candidates.push_back({i, log10_p});
    }
    std::ranges::sort(candidates, {}, &Candidate::log10_p);
    if (candidates.size() > kThresholds.most_joint_tests) candidates.resize(kThresholds.most_joint_tests);
    std::vector<std::size_t> chosen;
    for (const Candidate& each : candidates) chosen.push_back(each.scan);
    const Eigen::MatrixXd moved =
        scanned_displacements(state_.model(), setting.variables, *projector, scans, chosen);
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const auto column = moved.col(static_cast<Eigen::Index>(k));
      const double size = score_test(projector->project(column), 0, 1).amplitude[0];
      absorbed.push_back({chosen[k], scans[chosen[k]], column * size});
    }
  }
  return absorbed;
}

ModelTests JointNoiseTest::scans() const {
  ModelTests tests = state_.tests();
  const double log10_scans = tests.log10_scans();
  for (AbsorbedScan& absorbed : absorbed_scans()) {
    GenericTest& test = absorbed.test;
    const double least = chi_squared_quantile(log10_scan_risk() - log10_scans, test.dof);
    const auto [ratio, freedom] = joint_likelihood_ratio(
        state_.model(), absorbed.moved, problem_, state_.noise_estimate(), state_.noise_options(), least);
    test.lm = ratio;
    test.log10_p = std::min(0.0, log10_exceedance_of_estimated(ratio, test.dof, freedom));
    const bool known =
        tests.scan_exceeds[absorbed.scan] && tests.scans[absorbed.scan].log10_p <= test.log10_p;
    if (known || tests.family_wise_log10_p(test) > log10_scan_risk()) continue;
    state_.setting().rules.tell(SearchRule::AbsorbedScans);
    tests.scans[absorbed.scan] = test;
    tests.scan_exceeds[absorbed.scan] = true;
  }
  return tests;
}

}  // namespace volcal
