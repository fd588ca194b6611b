// EffectSearch: what stands out, and how well the noise is known that it stands on.

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "volcal/identify/criticism/catalogue/shape_refinement.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/projection/noise_freedom.h"
#include "volcal/identify/criticism/projection/score_statistics.h"
#include "volcal/identify/criticism/search/effect_search.h"
#include "volcal/identify/criticism/search/joint_noise.h"
#include "volcal/identify/stats/chi_squared.h"

namespace volcal {
namespace {

void keep_best(std::vector<FamilyTest>& tests) {
  std::ranges::sort(tests, std::greater{}, &FamilyTest::gain);
  if (tests.size() > kThresholds.most_joint_tests) tests.resize(kThresholds.most_joint_tests);
}

}  // namespace

/// Best first.
std::vector<std::size_t> EffectSearch::families_above() const {
  std::vector<std::size_t> above;
  for (std::size_t i = 0; i < tests_.size(); ++i) {
    if (is_above(tests_[i])) above.push_back(i);
  }
  std::ranges::sort(above, std::greater{}, [this](std::size_t i) { return tests_[i].gain; });
  return above;
}

/// Scans above the noise if that were known; none where so many are that something is there beyond doubt.
std::vector<std::size_t> EffectSearch::doubtful_scans() const {
  std::vector<std::size_t> above;
  for (std::size_t i = 0; i < generic_.size(); ++i) {
    if (scan_stands_out_[i]) above.push_back(i);
  }
  return above.size() > kThresholds.most_doubtful_scans ? std::vector<std::size_t>{} : above;
}

/// Above the noise, also where the noise that a name or a scan would stand on is hardly known.
void EffectSearch::find_outstanding() {
  outstanding_.clear();
  scan_stands_out_.clear();
  for (const GenericTest& test : generic_)
    scan_stands_out_.push_back(family_wise_log10_p(test) <= log10_scan_risk());
  const std::vector<std::size_t> names = families_above(), scans = doubtful_scans();
  if (names.empty() && scans.empty()) return;
  const auto of_names = static_cast<Eigen::Index>(names.size()),
             of_scans = static_cast<Eigen::Index>(scans.size());
  Eigen::MatrixXd moved(static_cast<Eigen::Index>(model_.size()), of_names + of_scans);
  for (Eigen::Index k = 0; k < of_names; ++k) {
    const FamilyTest& test = tests_[names[static_cast<std::size_t>(k)]];
    moved.col(k) = family_columns(model_, families_[test.family], test.shape) * test.score.amplitude;
  }
  moved.rightCols(of_scans) = scanned_displacements(model_, variables_, *projector_, generic_, scans);
  const std::vector<double> freedom = noise_freedom(
      moved, *projector_, noise_with_uncertainty(),
      [this](const auto& noise) { return projector_of(without(model_.problem().data, heldout_), noise); });
  for (std::size_t k = 0; k < names.size(); ++k) {
    const FamilyTest& test = tests_[names[k]];
    const double log10_p = log10_exceedance_of_estimated(test.score.lm, test.score.dof, freedom[k]) +
                           std::log10(test.multiplicity);
    if (log10_p + log10_families_ <= log10_family_risk()) outstanding_.push_back(names[k]);
  }
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const GenericTest& test = generic_[scans[k]];
    const double log10_p =
        log10_exceedance_of_estimated(test.lm, test.dof, freedom[names.size() + k]) + test.log10_choices;
    scan_stands_out_[scans[k]] = log10_p + log10_generic_ <= log10_scan_risk();
  }
}

/// Effects that would stand out were there hardly a wander: noise that was estimated without an effect can
/// have taken it for one.
std::vector<FamilyTest> EffectSearch::absorbed_by_drift(const NoiseProblem& problem) const {
  std::vector<FamilyTest> tests;
  for (const NoiseAlternative& other :
       noise_with_reduced_drift(problem, *noise_estimate_, options_.threads)) {
    const auto projector = projector_of(without(problem.data, heldout_), other.noise);
    for (FamilyTest& test : test_families(model_, families_, *projector, options_.threads)) {
      if (!may_be_added(test) || test.score.lm < other.loss - kThresholds.worth_joint_estimate) continue;
      refine_shape(model_, families_[test.family], *projector, test);
      test.gain -= other.loss;
      tests.push_back(std::move(test));
    }
  }
  keep_best(tests);
  return tests;
}

/// Effects above the noise, if it were as well known as that.
std::vector<FamilyTest> EffectSearch::above_doubtful_noise() const {
  std::vector<FamilyTest> tests;
  for (const FamilyTest& test : tests_) {
    if (may_be_added(test) && is_above(test)) tests.push_back(test);
  }
  keep_best(tests);
  return tests;
}

/// Where nothing stands out: the most promising of both, with the noise estimated beside them.
bool EffectSearch::add_hidden_in_noise() {
  if (options_.progress) options_.progress("effects that noise may hold", 0.9);
  const NoiseProblem problem = problem_with_added();
  std::vector<FamilyTest> tests = absorbed_by_drift(problem);
  std::ranges::move(above_doubtful_noise(), std::back_inserter(tests));
  for (FamilyTest& test : tests) {
    const double least = chi_squared_quantile(log10_family_risk() - log10_families_, test.score.dof);
    test_jointly(model_, families_[test.family], problem, *noise_estimate_, noise_options(), least, test);
  }
  const auto best = std::ranges::min_element(tests, {}, &FamilyTest::log10_p);
  if (best == tests.end() || family_wise_log10_p(*best) > log10_family_risk()) return false;
  add(FamilyTest(*best));
  return true;
}

/// Scans that would stand out were there hardly a wander, the most improbable of each instrument's.
std::vector<EffectSearch::ScanBesideNoise> EffectSearch::scans_absorbed_by_drift(
    const NoiseProblem& problem) const {
  struct Candidate {
    std::size_t scan;
    double log10_p;
  };
  std::vector<ScanBesideNoise> held;
  for (const NoiseAlternative& other :
       noise_with_reduced_drift(problem, *noise_estimate_, options_.threads)) {
    const auto projector = projector_of(without(problem.data, heldout_), other.noise);
    const std::vector<GenericTest> scans = generic_scan(model_, variables_, *projector, options_.threads);
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const double ratio = scans[i].lm - other.loss + kThresholds.worth_joint_estimate;
      if (!(ratio > 0.0) || scans[i].dof == 0.0) continue;
      const double log10_p = log10_chi_squared_exceedance(ratio, scans[i].dof);
      if (log10_p + log10_generic_ <= log10_scan_risk()) candidates.push_back({i, log10_p});
    }
    std::ranges::sort(candidates, {}, &Candidate::log10_p);
    if (candidates.size() > kThresholds.most_joint_tests) candidates.resize(kThresholds.most_joint_tests);
    std::vector<std::size_t> chosen;
    for (const Candidate& each : candidates) chosen.push_back(each.scan);
    const Eigen::MatrixXd moved = scanned_displacements(model_, variables_, *projector, scans, chosen);
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const auto column = moved.col(static_cast<Eigen::Index>(k));
      const double size = score_test(projector->project(column), 0, 1).amplitude[0];
      held.push_back({chosen[k], scans[chosen[k]], column * size});
    }
  }
  return held;
}

/// Where nothing stands out: those that do with the noise estimated beside them stand out in the place of the
/// tests that a wander has silenced.
void EffectSearch::find_scans_hidden_in_noise() {
  if (options_.progress) options_.progress("what noise may hold", 0.92);
  const NoiseProblem problem = problem_with_added();
  for (ScanBesideNoise& held : scans_absorbed_by_drift(problem)) {
    GenericTest& test = held.test;
    const double least = chi_squared_quantile(log10_scan_risk() - log10_generic_, test.dof);
    const auto [ratio, freedom] =
        test_jointly(model_, held.moved, problem, *noise_estimate_, noise_options(), least);
    test.lm = ratio;
    test.log10_p = std::min(0.0, log10_exceedance_of_estimated(ratio, test.dof, freedom));
    const bool known = scan_stands_out_[held.scan] && generic_[held.scan].log10_p <= test.log10_p;
    if (known || family_wise_log10_p(test) > log10_scan_risk()) continue;
    generic_[held.scan] = test;
    scan_stands_out_[held.scan] = true;
  }
}

}  // namespace volcal
