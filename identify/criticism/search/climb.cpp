#include "volcal/identify/criticism/search/climb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/search/errors_first.h"
#include "volcal/identify/criticism/search/joint_noise.h"
#include "volcal/identify/statistics/chi_squared.h"

namespace volcal {
namespace {

/// What names explain.
struct Evidence {
  double gain = 0.0;
  double log10_p = 0.0;  ///< family-wise
};

/// An unlisted effect of few terms has a larger gain among the polynomials; bumps and waves make a kernel
/// less probable than any name.
bool scan_does_better(const GenericTest& scan, double log10_p, const Evidence& names, double gain_margin,
                      double probability_margin) {
  return (!scan.kernel && scan.gain > names.gain + gain_margin) ||
         log10_p < (1.0 + probability_margin) * names.log10_p - 1.0;
}

}  // namespace

bool any_scan_does_better(const ModelState& state, const FamilyTest& name) {
  const SearchSetting& setting = state.setting();
  const auto any_beyond = [&](double margin) {
    return std::ranges::any_of(state.tests().scans, [&](const GenericTest& scan) {
      return scan_does_better(scan, state.tests().family_wise_log10_p(scan),
                              {name.gain, setting.family_wise_log10_p(name)}, kThresholds.scan_gain_margin,
                              margin);
    });
  };
  if (!any_beyond(kThresholds.scan_probability_margin)) return false;
  return !setting.rules.decide(SearchRule::ComponentMargin, [&] {
    return setting.families[name.family].independent_components() &&
           !any_beyond(kThresholds.scan_probability_margin_of_components);
  });
}

Reached Climb::run() {
  for (;;) {
    const std::size_t added = reached_.state.added().size();
    options_.report(fmt::format("tests, step {}", added + 1),
                    0.2 + 0.7 * std::min(1.0, static_cast<double>(added) / (options_.most + 1.0)));
    reached_.test();
    if (!reached_.given.is_tested()) reached_.given = reached_.state;
    if (effects_beyond_errors(reached_.state) >= options_.most) return std::move(reached_);
    if (!add_leading() && !add_several() && (reached_.something_exceeds() || !add_absorbed()))
      return std::move(reached_);
  }
}

/// False when nothing exceeds, or something that is in no catalogue does better.
bool Climb::add_leading() {
  const FamilyTest* own = reached_.leading_exceeding(
      [this](const FamilyTest& test) { return is_left_out(reached_.setting(), test); });
  const FamilyTest* best = reached_.leading_beside_open_errors(own);
  if (best == nullptr) return false;
  const FamilyTest* first = first_to_add(reached_.setting(), *best, own, [this](const FamilyTest& name) {
    return reached_.rules().decide(SearchRule::ScanVeto,
                                   [&] { return any_scan_does_better(reached_.state, name); });
  });
  if (first == nullptr) return false;
  reached_.add(*first);
  return true;
}

/// A scan sees two effects that share a variable at once, and then does better than the name of either; or
/// they hide each other, and nothing but the scan exceeds. False, and nothing added, unless with a few names
/// no scan exceeds and they explain, together, as much as the scan.
bool Climb::add_several() {
  if (!reached_.rules().follows(SearchRule::NamesTogether)) return false;
  std::set<std::size_t> start;
  for (const AddedEffect& effect : reached_.state.added()) start.insert(effect.test.family);
  if (!reached_.tried_together.insert(start).second) return false;
  const Reached before = reached_;
  for (int names = 1; names <= kThresholds.most_together; ++names) {
    if (effects_beyond_errors(reached_.state) >= options_.most) break;
    const FamilyTest* best = reached_.leading_beside_open_errors(nullptr);
    if (best == nullptr && names == 1) best = best_by_variables_of_scan();
    if (best == nullptr) break;
    reached_.rules().tell(SearchRule::NamesTogether);
    reached_.add(*best);
    reached_.test();
    if (!reached_.state.tests().any_scan_exceeds() && explain_together(before.state.added().size()))
      return true;
  }
  reached_ = before;
  return false;
}

/// Of the names that go with nothing but what the most improbable scan goes with; null: no scan exceeds.
const FamilyTest* Climb::best_by_variables_of_scan() const {
  const std::vector<const GenericTest*> scans = reached_.state.tests().exceeding_scans();
  if (scans.empty()) return nullptr;
  const GenericTest& least = **std::ranges::min_element(scans, {}, &GenericTest::log10_p);
  const FamilyTest* best = nullptr;
  for (const FamilyTest& test : reached_.state.tests().families) {
    if (!reached_.may_be_added(test) || (best != nullptr && test.gain <= best->gain)) continue;
    const std::vector<Variable> own = scan_variables_of(reached_.setting().families[test.family].name());
    const bool among = std::ranges::all_of(own, [&](const Variable& variable) {
      return std::ranges::find(least.variables, variable) != least.variables.end();
    });
    if (among && !own.empty() && reached_.open->admits(test)) best = &test;
  }
  return best;
}

/// No scan does better than the names from `first` on, at the noise that they leave: what was estimated
/// without them holds part of what they explain. Each name beyond the first pays for its choice.
bool Climb::explain_together(std::size_t first) const {
  const double log10_families = reached_.setting().log10_families;
  std::set<std::size_t> names;
  double price = 0.0, log10_choices = 0.0;
  Eigen::Index dof = 0;
  for (std::size_t i = first; i < reached_.state.added().size(); ++i) {
    const FamilyTest& test = reached_.state.added()[i].test;
    names.insert(i);
    price += test.score.lm - test.gain + (i > first ? 2.0 * std::numbers::ln10 * log10_families : 0.0);
    log10_choices += log10_families + std::log10(test.multiplicity);
    dof += reached_.state.added()[i].columns.cols();
  }
  const auto before = reached_.state.projector_without(names);
  const double lm = before->residual_squares() - reached_.state.projector().residual_squares();
  const double log10_p =
      std::min(0.0, log10_chi_squared_exceedance(lm, static_cast<double>(dof)) + log10_choices);
  const std::vector<GenericTest> scans =
      generic_scan(reached_.state.model(), reached_.setting().variables, *before, options_.threads);
  return std::ranges::none_of(scans, [&](const GenericTest& scan) {
    return scan_does_better(scan, reached_.state.tests().family_wise_log10_p(scan), {lm - price, log10_p},
                            kThresholds.scan_gain_margin_of_sufficient_names,
                            kThresholds.scan_probability_margin);
  });
}

/// Where nothing exceeds: what does jointly with the noise.
bool Climb::add_absorbed() {
  if (!reached_.rules().follows(SearchRule::AbsorbedEffects)) return false;
  options_.report("effects that noise may hold", 0.9);
  const std::optional<FamilyTest> best = JointNoiseTest(reached_.state).effect([&](const FamilyTest& test) {
    return reached_.may_be_added(test) && reached_.open->admits(test);
  });
  if (!best) return false;
  reached_.rules().tell(SearchRule::AbsorbedEffects);
  reached_.add(*best);
  return true;
}

}  // namespace volcal
