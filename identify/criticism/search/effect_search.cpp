#include "volcal/identify/criticism/search/effect_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "volcal/identify/criticism/catalogue/shape_refinement.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/solve/correlated_adjustment.h"
#include "volcal/identify/stats/chi_squared.h"

namespace volcal {

namespace {

void append(Eigen::MatrixXd& all, const Eigen::MatrixXd& more) {
  const Eigen::Index before = all.cols();
  all.conservativeResize(more.rows(), before + more.cols());
  all.rightCols(more.cols()) = more;
}

/// More resolution follows nearly anything; for the price of its columns it is no rival.
bool near(const FamilyTest& own, const FamilyTest& other, bool of_resolution) {
  return own.gain - other.gain < kThresholds.indistinguishable_gain ||
         (!of_resolution && own.score.lm - other.score.lm < kThresholds.indistinguishable_lm);
}

}  // namespace

EffectSearch::EffectSearch(LinearModel& model, std::vector<bool> heldout, SearchOptions options)
    : model_(model),
      heldout_(std::move(heldout)),
      options_(std::move(options)),
      families_(volcal::families(model)) {
  std::erase_if(families_, [this](const Family& family) {
    return std::ranges::find(options_.leave_out, family.name().kind) != options_.leave_out.end();
  });
  log10_families_ = std::log10(static_cast<double>(std::max<std::size_t>(families_.size(), 1)));
  variables_ = scan_variables(model_);
  constancy_variables_ = variables_;
  for (ScanVariable& variable : travel_since_turning(model_))
    constancy_variables_.push_back(std::move(variable));
}

void EffectSearch::run() {
  start();
  climb();
  settle([this] { climb(); });
  reject();
  if (!options_.climb) keep_one_step();
  if (!something_stands_out()) find_scans_hidden_in_noise();
  restate_ladder();
}

/// Until every added effect stands against its rivals.
void EffectSearch::settle(const std::function<void()>& after_a_change) {
  for (int change = 0; change < kThresholds.most_changes; ++change) {
    if (!reconsider(true)) return;
    after_a_change();
  }
  reconsider(false);
}

void EffectSearch::start() {
  if (options_.progress) options_.progress("noise model", 0.05);
  model_.return_to_fit();
  added_.clear();
  ladder_.clear();
  smoothing_of_steps_.clear();
  heldout_loglik_.reset();
  if (first_noise_) {
    noise_estimate_ = first_noise_->estimate;
    noise_ = noise_estimate_->parameters();
    model_.set_smoothing(first_noise_->smoothing);
    projector_ = projector_without({});
  } else {
    find_noise();
    first_noise_ = FirstNoise{*noise_estimate_, model_.smoothing()};
  }
  add_step("");
}

/// Noise of all readings, then smoothing under it by those that are not held out, as the projector that
/// chooses; twice where the smoothing changes, since either takes the other's part.
void EffectSearch::find_noise() {
  NoiseOptions noise = noise_options();
  noise.uncertainty = false;
  for (int round = 0; round < (model_.smoothing().empty() ? 1 : kThresholds.noise_rounds); ++round) {
    noise_estimate_ =
        estimate_noise(problem_with_added(), noise, noise_estimate_ ? &*noise_estimate_ : nullptr);
    noise_ = noise_estimate_->parameters();
    projector_ = projector_without({});
    if (model_.smoothing().empty()) return;
    const std::vector<SmoothingTerm> before = model_.smoothing();
    model_.smooth(projector_->gram(), projector_->observations());
    if (alike(before, model_.smoothing())) break;
  }
  projector_ = projector_without({});
}

NoiseOptions EffectSearch::noise_options() const {
  NoiseOptions noise;
  noise.threads = options_.threads;
  noise.wander_threshold = kThresholds.drift_evidence;
  return noise;
}

NoiseEstimate EffectSearch::noise_with_uncertainty() const {
  return estimate_noise(problem_with_added(), noise_options(), &*noise_estimate_);
}

std::unique_ptr<Projector> EffectSearch::projector_of_all_readings() const {
  return projector_of(model_.problem().data, noise_);
}

std::unique_ptr<Projector> EffectSearch::projector_without(const std::set<std::size_t>& left_out) const {
  return projector_of(without(model_.problem().data, heldout_), noise_, left_out);
}

std::unique_ptr<Projector> EffectSearch::projector_of(const NoiseData& data,
                                                      const std::vector<NoiseParameters>& noise,
                                                      const std::set<std::size_t>& left_out) const {
  auto projector =
      std::make_unique<Projector>(model_.problem(), data, noise, options_.threads, model_.parts());
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(model_.size()), 0);
  for (std::size_t i = 0; i < added_.size(); ++i) {
    if (!left_out.contains(i)) append(columns, added_[i].columns);
  }
  if (columns.cols() > 0) projector->accept(columns);
  return projector;
}

/// The linear model with the added effects as further columns.
NoiseProblem EffectSearch::problem_with_added() const {
  NoiseProblem problem = model_.problem();
  for (const AddedEffect& effect : added_) append(problem.jacobian, effect.columns);
  const Eigen::Index before = problem.prior_mean.size(), count = problem.jacobian.cols();
  Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(count, count);
  precision.topLeftCorner(before, before) = problem.prior_precision;
  problem.prior_precision = std::move(precision);
  problem.prior_mean.conservativeResize(count);
  problem.prior_mean.tail(count - before).setZero();
  return problem;
}

void EffectSearch::test() {
  tests_ = refined_tests(*projector_);
  generic_ = generic_scan(model_, variables_, *projector_, options_.threads);
  std::ranges::move(wave_tests(model_, *projector_, options_.threads), std::back_inserter(generic_));
  log10_generic_ = std::log10(static_cast<double>(std::max<std::size_t>(generic_.size(), 1)));
  find_outstanding();
}

std::vector<FamilyTest> EffectSearch::refined_tests(const Projector& projector) const {
  std::vector<FamilyTest> tests = test_families(model_, families_, projector, options_.threads);
  double best = 0.0;
  for (const FamilyTest& test : tests) best = std::max(best, test.gain);
  for (FamilyTest& test : tests) {
    if (test.gain > best - kThresholds.worth_refining_gain &&
        test.log10_p < kThresholds.worth_refining_log10_p)
      refine_shape(model_, families_[test.family], projector, test);
  }
  return tests;
}

void EffectSearch::climb() {
  for (;;) {
    if (options_.progress) {
      options_.progress(fmt::format("tests, step {}", added_.size() + 1),
                        0.2 + 0.7 * static_cast<double>(added_.size()) / (options_.most + 1.0));
    }
    test();
    if (first_tests_.empty()) {
      first_tests_ = tests_;
      first_generic_ = generic_;
    }
    if (static_cast<int>(added_.size()) >= options_.most) return;
    if (!add_leading() && !add_several() && (something_stands_out() || !add_hidden_in_noise())) return;
  }
}

/// The best of those that are not in the model; null: none.
const FamilyTest* EffectSearch::outstanding() const {
  const auto found =
      std::ranges::find_if(outstanding_, [this](std::size_t i) { return may_be_added(tests_[i]); });
  return found == outstanding_.end() ? nullptr : &tests_[*found];
}

bool EffectSearch::something_stands_out() const { return outstanding() != nullptr || !scans_are_silent(); }

std::vector<const GenericTest*> EffectSearch::outstanding_scans() const {
  std::vector<const GenericTest*> scans;
  for (std::size_t i = 0; i < generic_.size(); ++i) {
    if (scan_stands_out_[i]) scans.push_back(&generic_[i]);
  }
  return scans;
}

bool EffectSearch::scans_are_silent() const {
  return std::ranges::none_of(scan_stands_out_, std::identity{});
}

/// False when nothing stands out, or something that is in no catalogue stands out more.
bool EffectSearch::add_leading() {
  const FamilyTest* best = outstanding();
  if (best == nullptr || generic_does_better(*best)) return false;
  add(FamilyTest(*best));
  return true;
}

/// A scan sees two effects that share a variable at once, and then does better than the name of either; or
/// they hide each other, and nothing but the scan stands out. False, and nothing added, unless a few names
/// leave the scans silent and explain, together, as much as the scan.
bool EffectSearch::add_several() {
  const std::vector<FamilyTest> kept = added_tests();
  std::set<std::size_t> start;
  for (const FamilyTest& test : kept) start.insert(test.family);
  if (!tried_together_.insert(start).second) return false;
  for (int names = 1; names <= kThresholds.most_together && static_cast<int>(added_.size()) < options_.most;
       ++names) {
    const FamilyTest* best = outstanding();
    if (best == nullptr && names == 1) best = best_by_the_variables_of_a_scan();
    if (best == nullptr) break;
    add(FamilyTest(*best));
    test();
    if (scans_are_silent() && explain_together(kept.size())) return true;
  }
  if (added_.size() > kept.size()) {
    add_again(kept);
    test();
  }
  return false;
}

/// Of the names that go with nothing but what the most improbable scan goes with; null: no scan stands out.
const FamilyTest* EffectSearch::best_by_the_variables_of_a_scan() const {
  const std::vector<const GenericTest*> scans = outstanding_scans();
  if (scans.empty()) return nullptr;
  const GenericTest& leading = **std::ranges::min_element(scans, {}, &GenericTest::log10_p);
  const FamilyTest* best = nullptr;
  for (const FamilyTest& test : tests_) {
    if (!may_be_added(test) || (best != nullptr && test.gain <= best->gain)) continue;
    const std::vector<std::string> own = scan_variables_of(families_[test.family].name());
    const bool among = std::ranges::all_of(own, [&](const std::string& variable) {
      return std::ranges::find(leading.variables, variable) != leading.variables.end();
    });
    if (among && !own.empty()) best = &test;
  }
  return best;
}

/// No scan does better than the names from `first` on, at the noise that they leave: what was estimated
/// without them holds part of what they explain. Each name beyond the first pays for its choice.
bool EffectSearch::explain_together(std::size_t first) const {
  std::set<std::size_t> names;
  double price = 0.0, log10_choices = 0.0;
  Eigen::Index dof = 0;
  for (std::size_t i = first; i < added_.size(); ++i) {
    const FamilyTest& test = added_[i].test;
    names.insert(i);
    price += test.score.lm - test.gain + (i > first ? 2.0 * std::numbers::ln10 * log10_families_ : 0.0);
    log10_choices += log10_families_ + std::log10(test.multiplicity);
    dof += added_[i].columns.cols();
  }
  const auto before = projector_of(without(model_.problem().data, heldout_), noise_, names);
  const double lm = before->residual_squares() - projector_->residual_squares();
  const double log10_p =
      std::min(0.0, log10_chi_squared_exceedance(lm, static_cast<double>(dof)) + log10_choices);
  const std::vector<GenericTest> scans = generic_scan(model_, variables_, *before, options_.threads);
  return std::ranges::none_of(scans, [&](const GenericTest& scan) {
    return does_better(scan, {lm - price, log10_p}, kThresholds.scan_gain_margin_of_sufficient_names,
                       kThresholds.scan_probability_margin);
  });
}

void EffectSearch::add(const FamilyTest& test) {
  added_.push_back({test, accept(test, *projector_), {}});
  find_noise();
  if (refine_shape_of_last()) find_noise();
  while (reinstate_outliers() > 0) find_noise();
  add_step(families_[test.family].label());
}

/// At the noise that the effect leaves; its shape was found at the noise that held it. True: it has changed.
bool EffectSearch::refine_shape_of_last() {
  AddedEffect& last = added_.back();
  const Family& family = families_[last.test.family];
  if (family.scan.size() < 2 || last.columns.cols() == family.amplitudes()) return false;
  const auto projector = projector_without({added_.size() - 1});
  FamilyTest again = last.test;
  const ScoreTest score =
      score_test(projector->project(family_columns(model_, family, again.shape)), 0, family.amplitudes());
  update_test(again, family, again.shape, score, *projector);
  refine_shape(model_, family, *projector, again);
  if (again.shape == last.test.shape) return false;
  last.columns = accept(again, *projector);
  last.test = std::move(again);
  return true;
}

/// Columns of the amplitudes, and of the shape where the readings see it move, into the model of `projector`.
Eigen::MatrixXd EffectSearch::accept(const FamilyTest& test, Projector& projector) const {
  const Family& family = families_[test.family];
  Eigen::MatrixXd columns = family_columns(model_, family, test.shape);
  projector.accept(columns);
  const auto derivative = shape_derivative(model_, family, test.shape, test.score.amplitude);
  if (!derivative) return columns;
  const ProjectedColumns projected = projector.project(*derivative);
  if (projected.gram(0, 1)(0, 0) > std::pow(kThresholds.visible_derivative * projected.norm[0], 2)) {
    projector.accept(*derivative);
    append(columns, *derivative);
  }
  return columns;
}

/// Those that are no outliers of the model reached.
std::size_t EffectSearch::reinstate_outliers() {
  const NoiseProblem& problem = model_.problem();
  const Eigen::VectorXd solution = projector_->solution();
  const std::vector<double> sigma = total_sigma(problem.data, model_.stated_sigma(), noise_);
  Eigen::MatrixXd row(1, solution.size());
  return model_.take_up([&](std::size_t observation) {
    const auto at = static_cast<Eigen::Index>(observation);
    Eigen::Index column = problem.jacobian.cols();
    row.leftCols(column) = problem.jacobian.row(at);
    for (const AddedEffect& effect : added_) {
      row.middleCols(column, effect.columns.cols()) = effect.columns.row(at);
      column += effect.columns.cols();
    }
    const double miss = problem.residual[at] - row.row(0).dot(solution);
    const double u = std::hypot(sigma[observation], std::sqrt(projector_->prediction_variance(row)[0]));
    return std::abs(miss) < model_.outlier_critical_value() * u;
  });
}

void EffectSearch::add_step(const std::string& added) {
  std::vector<Eigen::MatrixXd> columns;
  for (const AddedEffect& effect : added_) columns.push_back(effect.columns);
  LadderStep step = ladder_step(model_, heldout_, noise_, *projector_, columns, heldout_loglik_);
  step.model = std::to_string(ladder_.size());
  step.added = added;
  ladder_.push_back(std::move(step));
  smoothing_of_steps_.push_back(model_.smoothing());
}

/// All steps against the noise of the model reached: noise estimated beside a missing effect holds part of
/// the effect, and would hide its fall.
void EffectSearch::restate_ladder() {
  std::vector<Eigen::MatrixXd> columns;
  heldout_loglik_.reset();
  for (std::size_t i = 0; i < ladder_.size(); ++i) {
    if (i > 0) columns.push_back(added_[i - 1].columns);
    model_.set_smoothing(smoothing_of_steps_[i]);
    Projector projector(model_.problem(), without(model_.problem().data, heldout_), noise_, options_.threads,
                        model_.parts());
    for (const Eigen::MatrixXd& each : columns) projector.accept(each);
    LadderStep step = ladder_step(model_, heldout_, noise_, projector, columns, heldout_loglik_);
    step.model = ladder_[i].model;
    step.added = ladder_[i].added;
    ladder_[i] = std::move(step);
  }
}

/// Each added effect against all others, now that the rest is in the model: true when one was exchanged or
/// left, and the climb goes on from there.
bool EffectSearch::reconsider(bool may_change) {
  std::vector<FamilyTest> kept = added_tests();
  for (std::size_t i = 0; i < added_.size(); ++i) {
    if (options_.progress) options_.progress("rivals of " + families_[kept[i].family].label(), 0.9);
    std::vector<FamilyTest> tests = refined_tests(*projector_without({i}));
    const FamilyTest& own = tests[kept[i].family];
    if (may_change && family_wise_log10_p(own) > log10_family_risk()) {
      dropped_.insert(own.family);
      kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(i));
      add_again(kept);
      return true;
    }
    const FamilyTest* best = leading(tests, kept[i].family);
    if (may_change && best != nullptr && best->gain > own.gain + kThresholds.indistinguishable_gain) {
      kept[i] = *best;
      add_again(kept);
      return true;
    }
    added_[i].test = own;
    added_[i].rivals.clear();
    for (const FamilyTest& test : tests) {
      const bool known = is_added(test.family) || given_up_.contains(test.family);
      const bool of_resolution = families_[test.family].resolution.has_value();
      if (test.score.dof > 0 && !known && near(own, test, of_resolution)) added_[i].rivals.push_back(test);
    }
    std::ranges::sort(added_[i].rivals, std::greater{}, &FamilyTest::gain);
  }
  return false;
}

/// The first effect, and the changes of the model before it.
void EffectSearch::keep_one_step() {
  const auto is_effect = [this](const AddedEffect& each) {
    return families_[each.test.family].effect != nullptr;
  };
  const auto first = std::ranges::find_if(added_, is_effect);
  if (first == added_.end() || first + 1 == added_.end()) return;
  more_is_known_ = std::any_of(first + 1, added_.end(), is_effect);
  const std::vector<AddedEffect> before(added_.begin(), first + 1);
  std::vector<FamilyTest> kept;
  std::ranges::transform(before, std::back_inserter(kept), &AddedEffect::test);
  add_again(kept);
  for (std::size_t i = 0; i < before.size(); ++i) added_[i].rivals = before[i].rivals;
  test();
}

/// The ladder from its beginning.
void EffectSearch::add_again(const std::vector<FamilyTest>& tests) {
  start();
  for (const FamilyTest& test : tests) add(test);
}

std::vector<FamilyTest> EffectSearch::added_tests() const {
  std::vector<FamilyTest> tests;
  for (const AddedEffect& effect : added_) tests.push_back(effect.test);
  return tests;
}

bool EffectSearch::is_added(std::size_t family) const {
  return std::ranges::any_of(added_, [&](const AddedEffect& each) { return each.test.family == family; });
}

/// Best of those that are not in the model, `but` one that is.
const FamilyTest* EffectSearch::leading(const std::vector<FamilyTest>& tests, std::size_t but) const {
  const FamilyTest* best = nullptr;
  for (const FamilyTest& test : tests) {
    if (!may_be_added(test) && (test.family != but || test.score.dof == 0)) continue;
    if (best == nullptr || test.gain > best->gain) best = &test;
  }
  return best;
}

bool EffectSearch::may_be_added(const FamilyTest& test) const {
  return test.score.dof > 0 && !is_added(test.family) && !given_up_.contains(test.family) &&
         !dropped_.contains(test.family);
}

bool EffectSearch::is_above(const FamilyTest& test) const {
  return test.score.dof > 0 && family_wise_log10_p(test) <= log10_family_risk();
}

/// An unlisted effect of few terms has a larger gain among the polynomials; bumps and waves make a kernel
/// less probable than any name.
bool EffectSearch::generic_does_better(const FamilyTest& best) const {
  const bool components = families_[best.family].independent_components();
  const double share =
      components ? kThresholds.scan_probability_margin_of_components : kThresholds.scan_probability_margin;
  return std::ranges::any_of(generic_, [&](const GenericTest& test) {
    return does_better(test, {best.gain, family_wise_log10_p(best)}, kThresholds.scan_gain_margin, share);
  });
}

bool EffectSearch::does_better(const GenericTest& scan, const Evidence& names, double more_gain,
                               double share) const {
  return (!scan.kernel && scan.gain > names.gain + more_gain) ||
         family_wise_log10_p(scan) < (1.0 + share) * names.log10_p - 1.0;
}

double EffectSearch::family_wise_log10_p(const FamilyTest& test) const {
  return std::min(0.0, test.log10_p + log10_families_);
}

double EffectSearch::family_wise_log10_p(const GenericTest& test) const {
  return std::min(0.0, test.log10_p + log10_generic_);
}

double EffectSearch::log10_level() const { return log10_family_risk() - log10_families_; }

}  // namespace volcal
