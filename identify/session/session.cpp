#include "volcal/identify/session/session.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/effect_findings.h"
#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/statistics/normal.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kContradiction = 0.25;  // of U95: a preview that is off by more was wrong
constexpr double kShareOfFit = 0.6;      // of the time of a full step

FitOptions fit_options(int threads, const SessionProgress& progress) {
  FitOptions options;
  options.threads = threads;
  options.outliers = OutlierPolicy::Remove;
  options.noise = NoisePolicy::White;  // found with the tests, as in a diagnosis
  options.progress = [progress](const std::string& stage, double done) {
    if (progress && !progress(stage, kShareOfFit * done)) throw SessionStopped("stopped at: " + stage);
  };
  return options;
}

void report(const SessionProgress& progress, const std::string& stage, double done) {
  if (progress && !progress(stage, done)) throw SessionStopped("stopped at: " + stage);
}

EffectName name_of(const EffectSpec& spec) { return find_effect(spec.kind)->make(spec, {})->name(); }

ModelSpec with_effects(ModelSpec model, const std::vector<EffectSpec>& effects) {
  model.effects.insert(model.effects.end(), effects.begin(), effects.end());
  return model;
}

/// Amplitudes as a full fit found them.
EffectFinding fitted_finding(const EffectSpec& spec, const FitResult& result) {
  const auto effect = find_effect(spec.kind)->make(spec, {});
  EffectFinding out;
  out.name = effect->name();
  out.label = effect_label(*effect);
  out.spec = spec;
  for (const EffectAmplitude& amplitude : effect->amplitudes()) {
    const ParameterBlock* block = result.layout.find_block(amplitude.label);
    if (block == nullptr) continue;  // one of the coefficients of a surface
    AmplitudeFigure& figure = out.amplitudes.emplace_back();
    figure.label = amplitude.label;
    figure.value = result.parameters[block->offset];
    figure.u = std::sqrt(std::max(0.0, result.covariance(block->offset, block->offset)));
    figure.unit = amplitude.unit();
    figure.si_per_unit = amplitude.si_per_unit();
    amplitude.keep(figure.value, out.spec.options);
  }
  return out;
}

/// By a full fit, which a linear preview should have foreseen.
bool contradicts(const EffectFinding& preview, const EffectFinding& fitted) {
  for (std::size_t k = 0; k < std::min(preview.amplitudes.size(), fitted.amplitudes.size()); ++k) {
    const double miss = std::abs(preview.amplitudes[k].value - fitted.amplitudes[k].value);
    if (miss > kContradiction * kCoverageFactor * fitted.amplitudes[k].u) return true;
  }
  return false;
}

}  // namespace

/// A model by a full fit, and what tests stand on.
struct Session::Fitted {
  ModelSpec model;
  FitResult result;
  ModelState state;
};

/// What stands behind a model of the tree.
struct Session::Node {
  std::shared_ptr<const Fitted> base;
  ModelState state;                              ///< with what was added since
  std::vector<EffectSpec> effects;               ///< added to the given model
  std::optional<std::vector<FamilyTest>> tests;  ///< of the state, once asked for

  std::size_t in_base() const { return effects.size() - state.added().size(); }
};

Session::Session(Campaign campaign, ModelSpec model, SessionOptions options)
    : options_(std::move(options)), campaign_(std::move(campaign)), given_(std::move(model)) {
  options_.threads = thread_count(options_.threads);
  auto base = fitted(given_, options_.progress);
  append({base, base->state, {}, {}}, "", ModelStanding::Fitted);
}

Session::~Session() = default;

std::shared_ptr<const Session::Fitted> Session::fitted(const ModelSpec& model,
                                                       const SessionProgress& progress) const {
  FitResult result = fit(campaign_, model, fit_options(options_.threads, progress));
  report(progress, "noise", kShareOfFit);
  const LinearModel linear(campaign_, result);
  auto setting = std::make_shared<const SearchSetting>(linear, heldout_lines(linear, options_.heldout_share),
                                                       std::vector<std::string>{}, options_.threads, own_);
  ModelState state(linear, std::move(setting));
  report(progress, "done", 1.0);
  return std::make_shared<const Fitted>(Fitted{model, std::move(result), std::move(state)});
}

const Campaign& Session::campaign() const { return campaign_; }
const std::vector<SessionModel>& Session::models() const { return models_; }
const SessionModel& Session::current() const { return models_[current_]; }
Session::Node& Session::node() const { return *nodes_[current_]; }
Eigen::VectorXd Session::residual() const { return node().state.residual(); }

const SessionModel& Session::append(Node made, std::string change, ModelStanding standing) {
  SessionModel shown;
  shown.number = models_.size();
  if (!models_.empty()) shown.parent = current_;
  shown.change = std::move(change);
  shown.standing = standing;
  describe(made, shown);
  nodes_.push_back(std::make_unique<Node>(std::move(made)));
  models_.push_back(std::move(shown));
  current_ = models_.size() - 1;
  undone_.clear();
  return models_.back();
}

void Session::describe(const Node& made, SessionModel& shown) const {
  shown.figures = last_step_of(made.state);
  shown.figures.model = std::to_string(shown.number);
  shown.figures.added = shown.change;
  shown.effects.clear();
  for (std::size_t i = 0; i < made.in_base(); ++i)
    shown.effects.push_back(fitted_finding(made.effects[i], made.base->result));
  if (made.state.added().empty()) return;
  for (EffectFinding& added : added_findings(made.state, made.state.projector()))
    shown.effects.push_back(std::move(added));
}

/// Tests of all effects at the current model, with those that the user thought of meanwhile.
const std::vector<FamilyTest>& Session::tests() {
  Node& here = node();
  const SearchSetting& known = here.state.setting();
  if (known.own != own_.size()) {
    here.state = here.state.with_setting(std::make_shared<const SearchSetting>(
        here.state.model(), known.heldout, std::vector<std::string>{}, options_.threads, own_));
    here.tests.reset();
  }
  if (!here.tests)
    here.tests = refined_tests(here.state.setting(), here.state.model(), here.state.projector());
  return *here.tests;
}

const FamilyTest& Session::test_of(const EffectName& effect) {
  const std::vector<FamilyTest>& all = tests();
  for (const FamilyTest& test : all) {
    const Family& family = node().state.setting().families[test.family];
    if (family.effect && family.name() == effect && !node().state.has(test.family)) return test;
  }
  throw std::invalid_argument(full_name(effect) + " is no effect that can be added to this model");
}

std::vector<EffectFinding> Session::rank() {
  std::vector<const FamilyTest*> order;
  for (const FamilyTest& test : tests()) {
    if (test.score.dof > 0 && !node().state.has(test.family)) order.push_back(&test);
  }
  std::ranges::stable_sort(order, std::greater{}, &FamilyTest::gain);
  std::vector<EffectFinding> ranking;
  for (const FamilyTest* test : order) ranking.push_back(finding(node().state.setting(), *test));
  return ranking;
}

EffectPreview Session::preview(const EffectName& effect) {
  const FamilyTest& test = test_of(effect);
  const ModelState& state = node().state;
  const Eigen::MatrixXd columns =
      family_columns(state.model(), state.setting().families[test.family], test.shape);
  const Eigen::VectorXd imitated = state.projector().imitation(columns) * test.score.amplitude;
  Eigen::Index at = state.model().problem().jacobian.cols();
  Eigen::VectorXd residual = state.residual() - columns * test.score.amplitude +
                             state.model().problem().jacobian * imitated.head(at);
  for (const AddedEffect& added : state.added()) {
    residual += added.columns * imitated.segment(at, added.columns.cols());
    at += added.columns.cols();
  }
  return {finding(state.setting(), test), std::move(residual)};
}

EffectPreview Session::formula(const EffectSpec& custom) {
  const EffectKind* kind = find_effect(custom.kind);
  if (kind == nullptr) throw std::invalid_argument(custom.kind + " is no kind of effect");
  const auto effect = kind->make(custom, {});
  effect->check(campaign_, {});
  const EffectName name = effect->name();
  const auto is_it = [&](const EffectSpec& spec) { return name_of(spec) == name; };
  if (std::ranges::none_of(own_, is_it)) own_.push_back(custom);
  return preview(name);
}

SelectionSummary Session::summary(const std::vector<bool>& selected) const {
  const Eigen::VectorXd residual = node().state.residual();
  const std::vector<double> variance =
      noise_variance(node().state.model().problem().data, node().state.noise());
  SelectionSummary out;
  double sum = 0.0, variances = 0.0, positive = 0.0;
  for (std::size_t i = 0; i < std::min(selected.size(), variance.size()); ++i) {
    if (!selected[i] || !std::isfinite(variance[i])) continue;
    const double value = residual[static_cast<Eigen::Index>(i)];
    ++out.readings;
    sum += value;
    variances += variance[i];
    positive += value > 0.0 ? 1.0 : 0.0;
  }
  if (out.readings == 0) return out;
  const auto count = static_cast<double>(out.readings);
  out.mean = sum / count;
  out.u = std::sqrt(variances) / count;
  out.share_positive = positive / count;
  return out;
}

const SessionModel& Session::add(const EffectName& effect) {
  const FamilyTest test = test_of(effect);
  Node next = node();
  const std::string label = next.state.setting().families[test.family].label();
  next.effects.push_back(finding(next.state.setting(), test).spec);
  next.state = next.state.with_at_this_noise(test);
  next.tests.reset();
  return append(std::move(next), "+ " + label, ModelStanding::Preview);
}

const SessionModel& Session::remove(const EffectName& effect, const SessionProgress& progress) {
  const Node& here = node();
  const auto found = std::ranges::find(here.effects, effect, name_of);
  if (found == here.effects.end())
    throw std::invalid_argument(full_name(effect) + " was not added to this model");
  const auto place = static_cast<std::size_t>(found - here.effects.begin());
  const std::string change = "- " + effect_label(*find_effect(found->kind)->make(*found, {}));
  Node next = here;
  next.effects.erase(next.effects.begin() + static_cast<std::ptrdiff_t>(place));
  next.tests.reset();
  if (place < here.in_base()) {
    next.base = fitted(with_effects(given_, next.effects), progress);
    next.state = next.base->state;
    return append(std::move(next), change, ModelStanding::Fitted);
  }
  next.state = here.base->state.with_setting(here.state.shared_setting());
  for (std::size_t i = 0; i < here.state.added().size(); ++i) {
    if (i != place - here.in_base()) next.state = next.state.with_at_this_noise(here.state.added()[i].test);
  }
  const auto standing = next.state.added().empty() ? ModelStanding::Fitted : ModelStanding::Preview;
  return append(std::move(next), change, standing);
}

const SessionModel& Session::confirm(const SessionProgress& progress) {
  SessionModel& shown = models_[current_];
  Node& here = node();
  if (here.state.added().empty()) return shown;
  const auto base = fitted(model(), progress);
  bool contradicted = false;
  for (std::size_t i = here.in_base(); i < here.effects.size(); ++i)
    contradicted |= contradicts(shown.effects[i], fitted_finding(here.effects[i], base->result));
  here.base = base;
  here.state = base->state;
  here.tests.reset();
  shown.standing = contradicted ? ModelStanding::Contradicted : ModelStanding::Fitted;
  describe(here, shown);
  return shown;
}

bool Session::undo() {
  if (!current().parent) return false;
  undone_.push_back(current_);
  current_ = *current().parent;
  return true;
}

bool Session::redo() {
  if (undone_.empty()) return false;
  current_ = undone_.back();
  undone_.pop_back();
  return true;
}

const SessionModel& Session::go_to(std::size_t number) {
  const SessionModel& wanted = models_.at(number);
  current_ = number;
  undone_.clear();
  return wanted;
}

ModelSpec Session::model() const {
  std::vector<EffectSpec> effects;
  for (const EffectFinding& effect : current().effects) effects.push_back(effect.spec);
  return with_effects(given_, effects);
}

}  // namespace volcal
