#include "volcal/identify/criticism/search/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/scans/amplitude_constancy.h"
#include "volcal/identify/criticism/search/errors_first.h"
#include "volcal/identify/criticism/search/joint_noise.h"
#include "volcal/identify/criticism/search/one_cause.h"
#include "volcal/identify/criticism/search/open_errors.h"
#include "volcal/identify/criticism/search/unknown_findings.h"
#include "volcal/identify/statistics/chi_squared.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

std::vector<FamilyTest> added_tests(const std::vector<AddedEffect>& added) {
  std::vector<FamilyTest> tests;
  std::ranges::transform(added, std::back_inserter(tests), &AddedEffect::test);
  return tests;
}

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

/// One cause on several axes is a name where its amplitude is the same on all of them.
bool acts_alike_in_its_places(const ModelState& state, const FamilyTest& test) {
  const Family& family = state.setting().families[test.family];
  return !acts_in_several_places(family) ||
         log10_p_of_one_amplitude(state.model(), family, test.shape, state.projector()) >
             std::log10(kThresholds.constancy_risk);
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

namespace {

std::shared_ptr<const SearchSetting> setting_of(const LinearModel& model, std::vector<bool> heldout,
                                                const SearchOptions& options) {
  auto setting = std::make_shared<SearchSetting>(model, std::move(heldout), options.leave_out,
                                                 options.threads, options.own);
  setting->rules = options.rules;
  return setting;
}

}  // namespace

Search::Search(LinearModel model, std::vector<bool> heldout, SearchOptions options)
    : options_(std::move(options)),
      model_(std::move(model)),
      setting_(setting_of(model_, std::move(heldout), options_)) {}

Search::Search(const ModelState& given, SearchOptions options)
    : options_(std::move(options)),
      model_(given.model()),
      setting_(setting_of(model_, given.setting().heldout, options_)),
      given_(given.with_setting(setting_)) {}

void Search::run() {
  start();
  explain();
  while (may_draw() && draw_one_cause()) explain();
  names_before_surfaces_ = state_->added().size();
  do {
    while (may_draw() && draw_surface()) explain();
  } while (widen_surface());
  replace_surfaces();
  settle_shapes();
  if (!options_.climb) keep_one_step();
  recall_rejected();
}

/// Where error functions came back: each takes part of what a shape was found by before it.
void Search::settle_shapes() {
  if (!any_function_came_back(*state_)) return;
  state_ = state_->with_settled_shapes();
  test();
}

void Search::report(const std::string& stage, double done) const {
  if (options_.progress) options_.progress(stage, done);
}

void Search::start() {
  report("noise model", 0.05);
  if (!given_) given_.emplace(model_, setting_);
  base_ = state_ = given_;
}

void Search::explain() {
  climb();
  settle([this] { climb(); });
  reject();
}

/// For what exceeds and has no name. False: nothing, or no surface explains it.
bool Search::draw_surface() {
  if (!rules().follows(SearchRule::Surfaces)) return false;
  const std::vector<UnknownFinding> findings = unknown_findings(*state_, rejected_);
  if (findings.empty()) return false;
  report("a surface for what has no name", 0.9);
  const std::optional<SurfaceTest> surface = best_surface(*state_, findings);
  if (!surface) return false;
  rules().tell(SearchRule::Surfaces);
  draw(*surface, added_tests(state_->added()));
  return true;
}

/// Not beside error functions that came back: the model that is fitted with them holds more of each than the
/// search does, and what it leaves is for the next diagnosis.
bool Search::may_draw() const {
  return static_cast<int>(base_->surfaces().size()) < kThresholds.most_surfaces &&
         !any_function_came_back(*state_);
}

/// Where two names stand for one cause whose shape no name has. False: none does.
bool Search::draw_one_cause() {
  if (state_->added().size() < 2 || !rules().follows(SearchRule::OneCause)) return false;
  report("one cause in the place of two", 0.9);
  const std::optional<OneCause> cause = one_cause_of_two(*state_);
  if (!cause) return false;
  rules().tell(SearchRule::OneCause);
  in_place_of_names_.insert(cause->surface.effect->name());
  draw(cause->surface, kept_beside(*cause));
  return true;
}

/// Where a surface lacks a variable that a name took up. False: nowhere.
bool Search::widen_surface() {
  if (base_->surfaces().empty() || state_->added().empty() || !rules().follows(SearchRule::WiderSurface))
    return false;
  report("one surface in the place of one and a name", 0.9);
  const std::optional<OneCause> cause = one_cause_of_surface_and_name(*state_);
  if (!cause) return false;
  rules().tell(SearchRule::WiderSurface);
  in_place_of_names_.insert(cause->surface.effect->name());
  std::vector<SurfaceTest> surfaces = surfaces_but(*cause->replaces_surface);
  surfaces.push_back(cause->surface);
  rebuild(surfaces, kept_beside(*cause));
  explain();
  return true;
}

std::vector<FamilyTest> Search::kept_beside(const OneCause& cause) const {
  std::vector<FamilyTest> kept;
  for (std::size_t i = 0; i < state_->added().size(); ++i) {
    if (!cause.replaces.contains(i)) kept.push_back(state_->added()[i].test);
  }
  return kept;
}

std::vector<SurfaceTest> Search::surfaces_but(std::size_t place) const {
  const std::vector<AddedSurface>& all = base_->surfaces();
  std::vector<SurfaceTest> others;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (k != place) others.push_back({all[k].spec, all[k].effect, all[k].finding, all[k].log_evidence});
  }
  return others;
}

void Search::draw(const SurfaceTest& surface, const std::vector<FamilyTest>& kept) {
  restart_with(kept);
  base_ = base_->with_surface(surface, state_->added());
  restart_with(kept);
  begin_anew();
}

/// With other surfaces and names in the model, names may explain what a surface was drawn for.
void Search::replace_surfaces() {
  if (!rules().follows(SearchRule::ReplacedSurfaces)) return;
  for (std::size_t i = 0; i < base_->surfaces().size();) {
    const std::vector<AddedSurface>& all = base_->surfaces();
    if (all.size() == 1 && state_->added().size() == names_before_surfaces_) return;
    if (in_place_of_names_.contains(all[i].effect->name())) {
      ++i;
      continue;
    }
    report("names in the place of " + effect_label(*all[i].effect), 0.9);
    const ModelState base = *base_, state = *state_;
    const Reasons rejected = rejected_;
    rules().tell(SearchRule::ReplacedSurfaces);
    rebuild(surfaces_but(i), added_tests(state_->added()));
    explain();
    if (!something_exceeds() && unknown_findings(*state_, rejected_).empty()) continue;
    base_ = base;
    state_ = state;
    rejected_ = rejected;
    ++i;
  }
}

void Search::rebuild(const std::vector<SurfaceTest>& surfaces, const std::vector<FamilyTest>& effects) {
  const std::vector<AddedEffect> beside = state_->added();
  base_ = given_;
  for (const SurfaceTest& surface : surfaces) base_ = base_->with_surface(surface, beside);
  restart_with(effects);
  begin_anew();
}

/// What was no name beside another model may be one now.
void Search::begin_anew() {
  rejected_before_.merge(rejected_);
  rejected_.clear();
  dropped_.clear();
  tried_together_.clear();
}

/// What was rejected on the way and did not return.
void Search::recall_rejected() {
  for (const auto& [family, reason] : rejected_before_) {
    if (!state_->has(family)) rejected_.try_emplace(family, reason);
  }
}

void Search::test() {
  state_ = state_->tested();
  open_.emplace(*state_);
}

void Search::restart_with(const std::vector<FamilyTest>& effects) {
  state_ = base_;
  for (const FamilyTest& effect : effects) add(effect);
}

void Search::climb() {
  for (;;) {
    const std::size_t added = state_->added().size();
    report(fmt::format("tests, step {}", added + 1),
           0.2 + 0.7 * std::min(1.0, static_cast<double>(added) / (options_.most + 1.0)));
    test();
    if (!given_->is_tested()) given_ = state_;
    if (effects_beyond_errors(*state_) >= options_.most) return;
    if (!add_leading() && !add_several() && (something_exceeds() || !add_absorbed())) return;
  }
}

bool Search::may_be_added(const FamilyTest& test) const {
  return test.score.dof > 0 && !state_->has(test.family) && !rejected_.contains(test.family) &&
         !dropped_.contains(test.family) &&
         !rules().decide(SearchRule::OneAmplitude, [&] { return !acts_alike_in_its_places(*state_, test); });
}

/// The best of those that are not in the model; null: none.
const FamilyTest* Search::leading_exceeding(const std::function<bool(const FamilyTest&)>& among) const {
  const ModelTests& tests = state_->tests();
  const auto found = std::ranges::find_if(tests.exceeding, [&](std::size_t i) {
    return among(tests.families[i]) && may_be_added(tests.families[i]);
  });
  return found == tests.exceeding.end() ? nullptr : &tests.families[*found];
}

/// What leads, an effect beyond the errors of the machine only where it comes before `own`, the best of
/// these, and exceeds beside those that the model holds at zero.
const FamilyTest* Search::leading_beside_open_errors(const FamilyTest* own) {
  return leading_exceeding([&](const FamilyTest& test) {
    return is_left_out(*setting_, test) ||
           ((own == nullptr || comes_before(*setting_, test, *own)) && open_->admits(test));
  });
}

bool Search::something_exceeds() {
  return leading_beside_open_errors(nullptr) != nullptr || state_->tests().any_scan_exceeds();
}

/// False when nothing exceeds, or something that is in no catalogue does better.
bool Search::add_leading() {
  const FamilyTest* own =
      leading_exceeding([this](const FamilyTest& test) { return is_left_out(*setting_, test); });
  const FamilyTest* best = leading_beside_open_errors(own);
  if (best == nullptr) return false;
  const FamilyTest* first = first_to_add(*setting_, *best, own, [this](const FamilyTest& name) {
    return rules().decide(SearchRule::ScanVeto, [&] { return any_scan_does_better(*state_, name); });
  });
  if (first == nullptr) return false;
  add(*first);
  return true;
}

/// A scan sees two effects that share a variable at once, and then does better than the name of either; or
/// they hide each other, and nothing but the scan exceeds. False, and nothing added, unless with a few names
/// no scan exceeds and they explain, together, as much as the scan.
bool Search::add_several() {
  if (!rules().follows(SearchRule::NamesTogether)) return false;
  const std::vector<FamilyTest> kept = added_tests(state_->added());
  std::set<std::size_t> start;
  for (const FamilyTest& test : kept) start.insert(test.family);
  if (!tried_together_.insert(start).second) return false;
  for (int names = 1; names <= kThresholds.most_together; ++names) {
    if (effects_beyond_errors(*state_) >= options_.most) break;
    const FamilyTest* best = leading_beside_open_errors(nullptr);
    if (best == nullptr && names == 1) best = best_by_variables_of_scan();
    if (best == nullptr) break;
    rules().tell(SearchRule::NamesTogether);
    add(*best);
    test();
    if (!state_->tests().any_scan_exceeds() && explain_together(kept.size())) return true;
  }
  if (state_->added().size() > kept.size()) {
    restart_with(kept);
    test();
  }
  return false;
}

/// Of the names that go with nothing but what the most improbable scan goes with; null: no scan exceeds.
const FamilyTest* Search::best_by_variables_of_scan() {
  const std::vector<const GenericTest*> scans = state_->tests().exceeding_scans();
  if (scans.empty()) return nullptr;
  const GenericTest& least = **std::ranges::min_element(scans, {}, &GenericTest::log10_p);
  const FamilyTest* best = nullptr;
  for (const FamilyTest& test : state_->tests().families) {
    if (!may_be_added(test) || (best != nullptr && test.gain <= best->gain)) continue;
    const std::vector<Variable> own = scan_variables_of(setting_->families[test.family].name());
    const bool among = std::ranges::all_of(own, [&](const Variable& variable) {
      return std::ranges::find(least.variables, variable) != least.variables.end();
    });
    if (among && !own.empty() && open_->admits(test)) best = &test;
  }
  return best;
}

/// No scan does better than the names from `first` on, at the noise that they leave: what was estimated
/// without them holds part of what they explain. Each name beyond the first pays for its choice.
bool Search::explain_together(std::size_t first) const {
  const double log10_families = setting_->log10_families;
  std::set<std::size_t> names;
  double price = 0.0, log10_choices = 0.0;
  Eigen::Index dof = 0;
  for (std::size_t i = first; i < state_->added().size(); ++i) {
    const FamilyTest& test = state_->added()[i].test;
    names.insert(i);
    price += test.score.lm - test.gain + (i > first ? 2.0 * std::numbers::ln10 * log10_families : 0.0);
    log10_choices += log10_families + std::log10(test.multiplicity);
    dof += state_->added()[i].columns.cols();
  }
  const auto before = state_->projector_without(names);
  const double lm = before->residual_squares() - state_->projector().residual_squares();
  const double log10_p =
      std::min(0.0, log10_chi_squared_exceedance(lm, static_cast<double>(dof)) + log10_choices);
  const std::vector<GenericTest> scans =
      generic_scan(state_->model(), setting_->variables, *before, options_.threads);
  return std::ranges::none_of(scans, [&](const GenericTest& scan) {
    return scan_does_better(scan, state_->tests().family_wise_log10_p(scan), {lm - price, log10_p},
                            kThresholds.scan_gain_margin_of_sufficient_names,
                            kThresholds.scan_probability_margin);
  });
}

/// Where nothing exceeds: what does jointly with the noise.
bool Search::add_absorbed() {
  if (!rules().follows(SearchRule::AbsorbedEffects)) return false;
  report("effects that noise may hold", 0.9);
  const std::optional<FamilyTest> best = JointNoiseTest(*state_).effect(
      [&](const FamilyTest& test) { return may_be_added(test) && open_->admits(test); });
  if (!best) return false;
  rules().tell(SearchRule::AbsorbedEffects);
  add(*best);
  return true;
}

/// Until every added effect stands against its rivals.
void Search::settle(const std::function<void()>& after_a_change) {
  for (int change = 0; change < kThresholds.most_changes; ++change) {
    if (!compare_with_rivals(true)) return;
    after_a_change();
  }
  compare_with_rivals(false);
}

/// Each added effect against all others, now that the rest is in the model: true when one was exchanged or
/// left, and the climb goes on from there. Error functions take as many terms as they have beside the others.
bool Search::compare_with_rivals(bool may_change) {
  std::vector<AddedEffect> added = state_->added();
  std::vector<FamilyTest> kept = added_tests(added);
  for (std::size_t i = 0; i < added.size(); ++i) {
    report("rivals of " + setting_->families[kept[i].family].label(), 0.9);
    const std::vector<FamilyTest> tests =
        refined_tests(*setting_, state_->model(), *state_->projector_without({i}));
    const FamilyTest& own = tests[kept[i].family];
    OpenErrors open(*state_, {i});
    const auto is_weak = [&] {
      return setting_->family_wise_log10_p(own) > log10_family_risk() || !open.admits(own);
    };
    if (may_change && rules().decide(SearchRule::Departure, is_weak)) {
      dropped_.insert(own.family);
      kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(i));
      restart_with(kept);
      return true;
    }
    const FamilyTest* best = leading(tests, own, open);
    const auto is_better = [&] { return best != nullptr && comes_before(*setting_, *best, own); };
    if (may_change && rules().decide(SearchRule::Exchange, is_better)) {
      kept[i] = *best;
      restart_with(kept);
      return true;
    }
    added[i].test = own;
    added[i].rivals.clear();
    for (const FamilyTest& test : tests) {
      const bool known = state_->has(test.family) || rejected_.contains(test.family) ||
                         (is_left_out(*setting_, own) && !is_left_out(*setting_, test));
      if (test.score.dof > 0 && !known && near(own, test)) added[i].rivals.push_back(test);
    }
    std::ranges::sort(added[i].rivals, std::greater{}, &FamilyTest::gain);
  }
  if (any_order_differs(*state_, added)) {
    restart_with(added_tests(added));
    test();
    std::vector<AddedEffect> anew = state_->added();
    for (std::size_t i = 0; i < anew.size(); ++i) {
      added[i].test.shape = anew[i].test.shape;  // that of its columns
      anew[i].test = std::move(added[i].test);
      anew[i].rivals = std::move(added[i].rivals);
    }
    added = std::move(anew);
  }
  state_ = state_->with_comparisons(std::move(added));
  return false;
}

/// By LM alone more resolution is no rival: for the price of its columns it follows nearly anything.
bool Search::near(const FamilyTest& own, const FamilyTest& other) const {
  if (own.gain - other.gain < kThresholds.indistinguishable_gain) return true;
  return rules().decide(SearchRule::NearByLm, [&] {
    return !setting_->families[other.family].resolution &&
           own.score.lm - other.score.lm < kThresholds.indistinguishable_lm;
  });
}

/// Of those that are not in the model, but `own`, which is.
const FamilyTest* Search::leading(const std::vector<FamilyTest>& tests, const FamilyTest& own,
                                  OpenErrors& open) const {
  return leading_errors_first(*setting_, tests, [&](const FamilyTest& test) {
    if (test.family == own.family) return test.score.dof > 0;
    return may_be_added(test) && (!comes_before(*setting_, test, own) || open.admits(test));
  });
}

void Search::reject() {
  const Rejection rejection(*state_);
  rejected_ = rejection.rejection_reasons();
  if (rejected_.empty()) return;
  std::vector<FamilyTest> kept;
  std::set<std::size_t> stood;
  for (std::size_t i = 0; i < state_->added().size(); ++i) {
    const FamilyTest& own = state_->added()[i].test;
    if (!rejected_.contains(own.family)) {
      stood.insert(own.family);
      kept.push_back(own);
    } else if (const FamilyTest* rival = rejection.standing_rival(i, rejected_)) {
      kept.push_back(*rival);
    }
  }
  keep(kept);
  if (rules().follows(SearchRule::Recheck)) recheck(stood);
}

/// What has come in place of others, if it is no name either, and what is weaker than what these have left.
void Search::recheck(const std::set<std::size_t>& stood) {
  const Rejection rejection(*state_);
  std::vector<FamilyTest> kept;
  for (std::size_t i = 0; i < state_->added().size(); ++i) {
    const AddedEffect& effect = state_->added()[i];
    std::optional<Finding> reason;
    if (!stood.contains(effect.test.family)) {
      reason = rejection.rejection_reason(i);
    } else if (rejection.leaves_more(effect)) {
      reason = Finding{FindingCode::RejectedUnnamedExceeds, {{"effect", state_->family_of(effect).label()}}};
    }
    if (reason) rejected_[effect.test.family] = *reason;
    if (!reason) kept.push_back(effect.test);
  }
  if (kept.size() == state_->added().size()) return;
  rules().tell(SearchRule::Recheck);
  keep(kept);
}

void Search::keep(const std::vector<FamilyTest>& effects) {
  restart_with(effects);
  settle([] {});
  test();
}

/// The first effect, and the changes of the model before it; or the first surface where no effect came
/// before.
void Search::keep_one_step() {
  if (base_->surfaces().size() == 1 && state_->added().empty()) return;
  if (!base_->surfaces().empty()) {
    const AddedSurface first = base_->surfaces().front();
    more_is_known_ = state_->added().size() > names_before_surfaces_;
    if (names_before_surfaces_ == 0) {
      rebuild({{first.spec, first.effect, first.finding, first.log_evidence}}, {});
    } else {
      rebuild({}, added_tests(state_->added()));
      settle([] {});
    }
    test();
    if (names_before_surfaces_ == 0) return;
  }
  const auto is_effect = [this](const AddedEffect& each) {
    return setting_->families[each.test.family].effect != nullptr;
  };
  const std::vector<AddedEffect>& added = state_->added();
  const auto first = std::ranges::find_if(added, is_effect);
  if (first == added.end() || first + 1 == added.end()) return;
  more_is_known_ = std::any_of(first + 1, added.end(), is_effect);
  const std::vector<AddedEffect> before(added.begin(), first + 1);
  restart_with(added_tests(before));
  std::vector<AddedEffect> kept = state_->added();
  for (std::size_t i = 0; i < before.size(); ++i) kept[i].rivals = before[i].rivals;
  state_ = state_->with_comparisons(std::move(kept));
  test();
}

}  // namespace volcal
