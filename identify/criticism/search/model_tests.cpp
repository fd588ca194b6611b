#include "volcal/identify/criticism/search/model_tests.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "volcal/identify/criticism/catalogue/shape_refinement.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/projection/noise_freedom.h"
#include "volcal/identify/criticism/scans/amplitude_constancy.h"
#include "volcal/identify/criticism/search/model_state.h"
#include "volcal/identify/statistics/chi_squared.h"

namespace volcal {
namespace {

double log10_count(std::size_t count) {
  return std::log10(static_cast<double>(std::max<std::size_t>(count, 1)));
}

/// Best first.
std::vector<std::size_t> families_above(const SearchSetting& setting, const ModelTests& tests) {
  std::vector<std::size_t> above;
  for (std::size_t i = 0; i < tests.families.size(); ++i) {
    if (setting.exceeds(tests.families[i])) above.push_back(i);
  }
  std::ranges::sort(above, std::greater{}, [&](std::size_t i) { return tests.families[i].gain; });
  return above;
}

/// Scans above the noise if that were known; none where so many are that something is there beyond doubt.
std::vector<std::size_t> doubtful_scans(const SearchRules& rules, const ModelTests& tests) {
  std::vector<std::size_t> above;
  for (std::size_t i = 0; i < tests.scans.size(); ++i) {
    if (tests.scan_exceeds[i]) above.push_back(i);
  }
  const bool beyond_doubt =
      rules.decide(SearchRule::DoubtfulScans, [&] { return above.size() > kThresholds.most_doubtful_scans; });
  return beyond_doubt ? std::vector<std::size_t>{} : above;
}

/// Above the noise, also where the noise that a name or a scan would stand on is hardly known.
void find_exceeding(const ModelState& state, ModelTests& tests) {
  const SearchSetting& setting = state.setting();
  for (const GenericTest& scan : tests.scans)
    tests.scan_exceeds.push_back(tests.family_wise_log10_p(scan) <= log10_scan_risk());
  const std::vector<std::size_t> names = families_above(setting, tests);
  if (!setting.rules.follows(SearchRule::EstimatedNoise)) {
    tests.exceeding = names;
    return;
  }
  const std::vector<std::size_t> scans = doubtful_scans(setting.rules, tests);
  if (names.empty() && scans.empty()) return;
  const auto of_names = static_cast<Eigen::Index>(names.size()),
             of_scans = static_cast<Eigen::Index>(scans.size());
  Eigen::MatrixXd moved(static_cast<Eigen::Index>(state.model().size()), of_names + of_scans);
  for (Eigen::Index k = 0; k < of_names; ++k) {
    const FamilyTest& test = tests.families[names[static_cast<std::size_t>(k)]];
    moved.col(k) = displacement(state.model(), setting.families[test.family], test);
  }
  moved.rightCols(of_scans) =
      scanned_displacements(state.model(), setting.variables, state.projector(), tests.scans, scans);
  const std::vector<double> freedom =
      noise_freedom(moved, state.projector(), state.noise_with_uncertainty(),
                    [&](const auto& noise) { return state.projector_at(noise); });
  for (std::size_t k = 0; k < names.size(); ++k) {
    const FamilyTest& test = tests.families[names[k]];
    const double log10_p = log10_exceedance_of_estimated(test.score.lm, test.score.dof, freedom[k]) +
                           std::log10(test.multiplicity);
    if (log10_p + setting.log10_families <= log10_family_risk()) {
      tests.exceeding.push_back(names[k]);
    } else {
      setting.rules.tell(SearchRule::EstimatedNoise);
    }
  }
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const GenericTest& scan = tests.scans[scans[k]];
    const double log10_p =
        log10_exceedance_of_estimated(scan.lm, scan.dof, freedom[names.size() + k]) + scan.log10_choices;
    tests.scan_exceeds[scans[k]] = log10_p + tests.log10_scans() <= log10_scan_risk();
    if (!tests.scan_exceeds[scans[k]]) setting.rules.tell(SearchRule::EstimatedNoise);
  }
}

}  // namespace

SearchSetting::SearchSetting(const LinearModel& model, std::vector<bool> held,
                             const std::vector<std::string>& leave_out, int thread_count,
                             std::span<const EffectSpec> own_effects)
    : families(volcal::families(model, own_effects)),
      variables(scan_variables(model)),
      constancy_variables(variables),
      heldout(std::move(held)),
      own(own_effects.size()),
      threads(thread_count) {
  std::erase_if(families, [&](const Family& family) {
    return std::ranges::find(leave_out, family.name().kind) != leave_out.end();
  });
  set_level();
  std::ranges::move(travel_since_turning(model), std::back_inserter(constancy_variables));
}

void SearchSetting::set_level() {
  log10_families = log10_count(families.size());
  std::size_t most = 1;
  for (const Family& family : families) most = std::max(most, static_cast<std::size_t>(family.amplitudes()));
  detectable_.clear();
  for (std::size_t dof = 1; dof <= most; ++dof)
    detectable_.push_back(
        volcal::detectable_noncentrality(log10_level(), static_cast<double>(dof), kThresholds.power));
}

double SearchSetting::detectable_noncentrality(int dof) const {
  return detectable_.at(static_cast<std::size_t>(std::max(1, dof) - 1));
}

SearchSetting SearchSetting::with_more(const LinearModel& model, std::span<const EffectSpec> more) const {
  SearchSetting all = *this;
  std::ranges::move(own_families(model, more), std::back_inserter(all.families));
  all.own += more.size();
  all.set_level();
  return all;
}

double SearchSetting::family_wise_log10_p(const FamilyTest& test) const {
  return std::min(0.0, test.log10_p + log10_families);
}

double SearchSetting::log10_level() const { return log10_family_risk() - log10_families; }

bool SearchSetting::exceeds(const FamilyTest& test) const {
  return test.score.dof > 0 && family_wise_log10_p(test) <= log10_family_risk();
}

double ModelTests::log10_scans() const { return log10_count(scans.size()); }

double ModelTests::family_wise_log10_p(const GenericTest& scan) const {
  return std::min(0.0, scan.log10_p + log10_scans());
}

std::vector<const GenericTest*> ModelTests::exceeding_scans() const {
  std::vector<const GenericTest*> exceeding_scans;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (scan_exceeds[i]) exceeding_scans.push_back(&scans[i]);
  }
  return exceeding_scans;
}

bool ModelTests::any_scan_exceeds() const { return std::ranges::any_of(scan_exceeds, std::identity{}); }

namespace {

/// Where they could matter, from one place on.
void refine_shapes_of(const SearchSetting& setting, const LinearModel& model, const Projector& projector,
                      std::size_t from, std::vector<FamilyTest>& tests) {
  double best = 0.0;
  for (const FamilyTest& test : tests) best = std::max(best, test.gain);
  std::vector<FamilyTest*> worth;
  for (FamilyTest& test : std::span(tests).subspan(from)) {
    if (test.gain > best - kThresholds.worth_refining_gain &&
        test.log10_p < kThresholds.worth_refining_log10_p)
      worth.push_back(&test);
  }
  refine_shapes(model, setting.families, projector, setting.threads, worth);
}

}  // namespace

std::vector<FamilyTest> refined_tests(const SearchSetting& setting, const LinearModel& model,
                                      const Projector& projector) {
  std::vector<FamilyTest> tests = test_families(model, setting.families, projector, setting.threads);
  refine_shapes_of(setting, model, projector, 0, tests);
  return tests;
}

CatalogueTests::CatalogueTests(FamilyProducts of, const ModelState& state)
    : products(std::move(of)),
      families(products.tests(state.setting().families, state.projector(), state.setting().threads)) {
  refine_shapes_of(state.setting(), state.model(), state.projector(), 0, families);
}

CatalogueTests::CatalogueTests(const ModelState& state)
    : CatalogueTests(
          FamilyProducts(state.model(), state.setting().families, state.projector(), state.setting().threads),
          state) {}

CatalogueTests CatalogueTests::of_next(const ModelState& before, const ModelState& next) const {
  return {products.accepting(next.added().back().columns, before.model(), before.setting().families,
                             before.projector(), before.setting().threads),
          next};
}

CatalogueTests CatalogueTests::with_more(const ModelState& with_them) const {
  const SearchSetting& setting = with_them.setting();
  CatalogueTests all = *this;
  const std::size_t known = families.size();
  all.products =
      products.with_more(with_them.model(), setting.families, with_them.projector(), setting.threads);
  std::ranges::move(all.products.tests(setting.families, with_them.projector(), setting.threads, known),
                    std::back_inserter(all.families));
  refine_shapes_of(setting, with_them.model(), with_them.projector(), known, all.families);
  return all;
}

ModelTests tests_of(const ModelState& state) {
  return tests_of(state, refined_tests(state.setting(), state.model(), state.projector()));
}

ModelTests tests_of(const ModelState& state, std::vector<FamilyTest> families) {
  const SearchSetting& setting = state.setting();
  ModelTests tests;
  tests.families = std::move(families);
  tests.scans = generic_scan(state.model(), setting.variables, state.projector(), setting.threads);
  std::ranges::move(wave_tests(state.model(), state.projector(), setting.threads),
                    std::back_inserter(tests.scans));
  find_exceeding(state, tests);
  return tests;
}

}  // namespace volcal
