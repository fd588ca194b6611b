#include "volcal/identify/session/session.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/effect_findings.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/criticism/search/search.h"
#include "volcal/identify/criticism/search/surface_search.h"
#include "volcal/identify/criticism/search/unknown_findings.h"
#include "volcal/identify/criticism/surface_findings.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/statistics/normal.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kContradiction = 0.25;  // of U95: a preview that is off by more was wrong
constexpr double kShareOfFit = 0.6;      // of the time of a full step
constexpr double kShareOfNoise = 0.9;    // with that of the noise
constexpr double kShareOfSearch = 0.8;   // of the time of a climb

void report(const SessionProgress& progress, const std::string& stage, double done) {
  if (progress && !progress(stage, done)) throw SessionStopped("stopped at: " + stage);
}

FitOptions fit_options(int threads, const SessionProgress& progress) {
  FitOptions options;
  options.threads = threads;
  options.outliers = OutlierPolicy::Remove;
  options.noise = NoisePolicy::White;  // found with the tests, as in a diagnosis
  options.progress = [progress](const std::string& stage, double done) {
    report(progress, stage, kShareOfFit * done);
  };
  return options;
}

std::vector<EffectFinding> with(std::vector<EffectFinding> effects, EffectFinding more) {
  effects.push_back(std::move(more));
  return effects;
}

std::vector<EffectFinding> without(std::vector<EffectFinding> effects, std::size_t place) {
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(place));
  return effects;
}

/// As a full fit found it.
EffectFinding fitted_finding(const EffectFinding& added, const FitResult& result) {
  EffectFinding out;
  out.name = added.name;
  out.label = added.label;
  out.spec = added.spec;
  for (const EffectSpec& spec : result.identified.effects) {
    const auto effect = find_effect(spec.kind)->make(spec, {});
    if (effect->name() != added.name) continue;
    out.spec = spec;
    for (const EffectAmplitude& amplitude : effect->amplitudes()) {
      const ParameterBlock* block = result.layout.find_block(amplitude.label);
      if (block == nullptr) continue;  // one of the coefficients of a surface
      const double u = std::sqrt(std::max(0.0, result.covariance(block->offset, block->offset)));
      out.amplitudes.push_back({amplitude.label, result.parameters[block->offset], u,
                                std::numeric_limits<double>::quiet_NaN(), amplitude.unit(),
                                amplitude.si_per_unit()});
    }
  }
  return out;
}

/// By a full fit, which a linear preview should have foreseen; the amplitude that is off by most of its U.
std::optional<Contradiction> contradiction_of(const EffectFinding& preview, const EffectFinding& fitted) {
  std::optional<Contradiction> worst;
  double most = kContradiction * kCoverageFactor;
  for (std::size_t k = 0; k < std::min(preview.amplitudes.size(), fitted.amplitudes.size()); ++k) {
    const AmplitudeFigure& before = preview.amplitudes[k];
    const AmplitudeFigure& after = fitted.amplitudes[k];
    const double miss = std::abs(before.value - after.value);
    if (miss <= most * after.u) continue;
    most = miss / after.u;
    worst = {after.label, before.value, after.value, after.u, after.unit, after.si_per_unit};
  }
  return worst;
}

/// Best first.
void sort_by_gain(std::vector<const FamilyTest*>& tests) {
  std::ranges::stable_sort(tests, std::greater{}, [](const FamilyTest* test) { return test->gain; });
}

double rms_of_heldout(const ModelState& state, const Eigen::VectorXd& residual) {
  const std::vector<bool>& heldout = state.setting().heldout;
  const std::vector<double>& sigma = state.model().problem().data.sigma;
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < heldout.size(); ++i) {
    if (!heldout[i] || !std::isfinite(sigma[i])) continue;
    const double value = residual[static_cast<Eigen::Index>(i)];
    squares += value * value;
    count += 1.0;
  }
  return std::sqrt(squares / count);
}

double mean_noise_variance(const ModelState& state) {
  double sum = 0.0, count = 0.0;
  for (const double variance : noise_variance(state.model().problem().data, state.noise())) {
    if (!std::isfinite(variance)) continue;
    sum += variance;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

/// Marks observations as left out. The number of those that were not yet.
std::size_t leave_out(const LinearModel& model, const std::vector<bool>& selected, const std::string& reason,
                      Campaign& campaign) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < std::min(selected.size(), model.size()); ++i) {
    if (!selected[i]) continue;
    const auto& [setup, row, channel] = model.observations()[i];
    std::vector<LeftOutReading>& known = campaign.setups[setup].left_out;
    const std::pair place{row, static_cast<std::size_t>(channel)};
    const auto at = std::ranges::lower_bound(known, place, {}, [](const LeftOutReading& each) {
      return std::pair{each.row, each.channel};
    });
    if (at != known.end() && std::pair{at->row, at->channel} == place) continue;
    known.insert(at, {place.first, place.second, reason});
    ++count;
  }
  return count;
}

}  // namespace

/// A model by a full fit, and what tests stand on.
struct Session::Fitted {
  std::shared_ptr<const Campaign> campaign;
  FitResult result;
  ModelState state;
  double noise_variance;  ///< mean over the readings in use
  std::vector<LadderStep>
      figures;  ///< of the models before, against this noise, where it is the least so far
};

/// What stands behind a model of the tree.
struct Session::Node {
  std::shared_ptr<const Fitted> base;
  ModelState state;                              ///< with what was added since
  std::vector<EffectFinding> effects;            ///< added to the given model
  std::optional<std::vector<FamilyTest>> tests;  ///< of the state, once asked for
  std::optional<std::vector<EffectFinding>> ranking;
  std::optional<ModelState> scanned;    ///< the state with all tests, once asked for
  std::vector<UnknownFinding> unknown;  ///< of that
  std::vector<SurfaceFinding> drawn;    ///< for some of these
  std::optional<Eigen::VectorXd> residual;

  Node(std::shared_ptr<const Fitted> fitted, std::vector<EffectFinding> added)
      : base(std::move(fitted)), state(base->state), effects(std::move(added)) {}
  /// With another state.
  void becomes(ModelState next) {
    state = std::move(next);
    tests.reset();
    ranking.reset();
    scanned.reset();
    unknown.clear();
    drawn.clear();
    residual.reset();
  }
  std::size_t in_base() const { return effects.size() - state.added().size(); }
};

/// What full fits need, apart from the session.
struct Session::Fitting {
  SessionOptions options;
  std::vector<EffectSpec> own;
  std::vector<ModelState> before;  ///< models of the tree
  double least_variance;           ///< of these

  std::shared_ptr<const Fitted> operator()(const std::shared_ptr<const Campaign>& campaign,
                                           const ModelSpec& model, const SessionProgress& progress) const {
    FitResult result = fit(*campaign, model, fit_options(options.threads, progress));
    report(progress, "noise", kShareOfFit);
    const LinearModel linear(*campaign, result);
    auto setting = std::make_shared<const SearchSetting>(linear, heldout_lines(linear, options.heldout_share),
                                                         std::vector<std::string>{}, options.threads, own);
    ModelState state(linear, std::move(setting));
    report(progress, "models against this noise", kShareOfNoise);
    const double variance = mean_noise_variance(state);
    std::vector<LadderStep> figures;
    for (std::size_t i = 0; i < before.size() && variance < least_variance; ++i)
      figures.push_back(last_step_at(before[i], state.noise()));
    report(progress, "done", 1.0);
    return std::make_shared<const Fitted>(
        Fitted{campaign, std::move(result), std::move(state), variance, std::move(figures)});
  }
};

Session::Session(Campaign campaign, ModelSpec model, SessionOptions options)
    : options_(std::move(options)), given_(std::move(model)) {
  options_.threads = thread_count(options_.threads);
  const auto shared = std::make_shared<const Campaign>(std::move(campaign));
  appending(0, Node(fitting()(shared, given_, options_.progress), {}), "")(*this);
}

Session::~Session() = default;

Session::Fitting Session::fitting() const {
  std::vector<ModelState> before;
  for (const auto& node : nodes_) before.push_back(node->state);
  return {options_, own_, std::move(before),
          least_ ? least_->noise_variance : std::numeric_limits<double>::max()};
}

/// Noise that was estimated without an effect holds part of it and hides its fall, so that all models are
/// told against the least noise that a full fit has found.
void Session::put_in_place(const std::shared_ptr<const Fitted>& fitted) {
  if (least_ && fitted->noise_variance >= least_->noise_variance) return;
  least_ = fitted;
  for (std::size_t i = 0; i < std::min(fitted->figures.size(), models_.size()); ++i)
    set_figures(fitted->figures[i], models_[i]);
}

void Session::set_figures(LadderStep figures, SessionModel& shown) {
  shown.figures = std::move(figures);
  shown.figures.model = std::to_string(shown.number);
  shown.figures.added = shown.change;
}
const Campaign& Session::campaign() const { return *node().base->campaign; }
const std::vector<SessionModel>& Session::models() const { return models_; }
const SessionModel& Session::current() const { return models_[current_]; }
const LinearModel& Session::linear() const { return node().state.model(); }
const std::vector<bool>& Session::heldout() const { return node().state.setting().heldout; }
const FitResult& Session::fitted_result() const { return node().base->result; }

const Eigen::VectorXd& Session::residual(std::size_t model) const {
  Node& of = *nodes_.at(model);
  if (!of.residual) of.residual = of.state.residual();
  return *of.residual;
}

Eigen::VectorXd Session::sigma(std::size_t model) const {
  const ModelState& state = nodes_.at(model)->state;
  const std::vector<double> variance = noise_variance(state.model().problem().data, state.noise());
  return Eigen::Map<const Eigen::VectorXd>(variance.data(), static_cast<Eigen::Index>(variance.size()))
      .cwiseSqrt();
}

const SessionModel& Session::append(std::size_t parent, Node made, std::string change,
                                    ModelStanding standing) {
  SessionModel shown;
  shown.number = models_.size();
  if (!models_.empty()) shown.parent = parent;
  shown.change = std::move(change);
  shown.standing = standing;
  describe(made, shown);
  nodes_.push_back(std::make_unique<Node>(std::move(made)));
  models_.push_back(std::move(shown));
  current_ = models_.size() - 1;
  undone_.clear();
  return models_.back();
}

SessionChange Session::appending(std::size_t parent, Node made, std::string change) {
  return [parent, made = std::move(made), change = std::move(change)](Session& session) {
    session.put_in_place(made.base);
    session.append(parent, made, change, ModelStanding::Fitted);
  };
}

void Session::describe(const Node& made, SessionModel& shown) const {
  const bool at_least = made.base == least_;
  set_figures(at_least ? last_step_of(made.state) : last_step_at(made.state, least_->state.noise()), shown);
  shown.effects.clear();
  for (std::size_t i = 0; i < made.in_base(); ++i)
    shown.effects.push_back(fitted_finding(made.effects[i], made.base->result));
  if (made.state.added().empty()) return;
  for (EffectFinding& added : added_findings(made.state, made.state.projector()))
    shown.effects.push_back(std::move(added));
}

/// With the effects that the user thought of meanwhile.
void Session::renew_setting() {
  Node& here = node();
  const SearchSetting& known = here.state.setting();
  if (known.own == own_.size()) return;
  const std::vector<EffectSpec> more(own_.begin() + static_cast<std::ptrdiff_t>(known.own), own_.end());
  here.state = here.state.with_setting(std::make_shared<const SearchSetting>(
      here.state.model(), known.heldout, std::vector<std::string>{}, options_.threads, own_));
  if (here.tests)
    here.tests = with_tests_of_own(*std::move(here.tests), more, here.state.setting(), here.state.model(),
                                   here.state.projector());
  here.ranking.reset();
}

/// Tests of all effects at the current model.
const std::vector<FamilyTest>& Session::tests() {
  renew_setting();
  Node& here = node();
  if (!here.tests)
    here.tests = refined_tests(here.state.setting(), here.state.model(), here.state.projector());
  return *here.tests;
}

SessionWork Session::scan() {
  renew_setting();
  return [state = node().state, known = node().tests,
          number = current_](const SessionProgress& progress) -> SessionChange {
    report(progress, "tests of the catalogue", 0.1);
    std::vector<FamilyTest> families =
        known ? *known : refined_tests(state.setting(), state.model(), state.projector());
    report(progress, "scans without a catalogue", 0.3);
    const ModelState scanned = state.with_tests(tests_of(state, std::move(families)));
    std::vector<UnknownFinding> unknown = unknown_findings(scanned, {});
    report_what_is_certain(unknown);
    report(progress, "done", 1.0);
    return [scanned, unknown = std::move(unknown), number](Session& session) {
      Node& of = *session.nodes_[number];
      of.scanned = scanned;
      of.unknown = unknown;
    };
  };
}

bool Session::is_scanned() const { return node().scanned.has_value(); }

/// With the scans.
const ModelState& Session::scanned() {
  renew_setting();
  if (!is_scanned()) scan()({})(*this);
  return *node().scanned;
}

const FamilyTest& Session::test_of(const EffectName& effect) {
  const std::vector<FamilyTest>& all = tests();
  for (const FamilyTest& test : all) {
    const Family& family = node().state.setting().families[test.family];
    if (family.effect && family.name() == effect && !node().state.has(test.family)) return test;
  }
  throw std::invalid_argument(full_name(effect) + " is no effect that can be added to this model");
}

/// What shows and is not in the model, best first.
std::vector<const FamilyTest*> Session::ranked() {
  std::vector<const FamilyTest*> order;
  for (const FamilyTest& test : tests()) {
    if (test.score.dof > 0 && !node().state.has(test.family)) order.push_back(&test);
  }
  sort_by_gain(order);
  return order;
}

const std::vector<EffectFinding>& Session::rank() {
  const std::vector<const FamilyTest*> order = ranked();
  Node& here = node();
  if (!here.ranking) {
    here.ranking.emplace();
    for (const FamilyTest* test : order) here.ranking->push_back(finding(here.state.setting(), *test));
  }
  return *here.ranking;
}

std::vector<EffectFinding> Session::not_visible() {
  std::vector<EffectFinding> hidden;
  for (const FamilyTest& test : tests()) {
    if (test.score.dof == 0) hidden.push_back(finding(node().state.setting(), test));
  }
  return hidden;
}

Rivalry Session::rivals(std::size_t most) {
  std::vector<const FamilyTest*> leading = ranked();
  std::erase_if(leading, [&](const FamilyTest* test) {
    return node().state.setting().families[test->family].effect == nullptr;
  });
  leading.resize(std::min(leading.size(), most));
  const ModelState& state = node().state;
  const auto count = static_cast<Eigen::Index>(leading.size());
  Rivalry rivalry{{}, Eigen::MatrixXd::Identity(count, count)};
  if (leading.empty()) return rivalry;
  Eigen::MatrixXd moved(static_cast<Eigen::Index>(state.model().size()), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const FamilyTest& test = *leading[static_cast<std::size_t>(k)];
    const Family& family = state.setting().families[test.family];
    rivalry.names.push_back(family.name());
    moved.col(k) = displacement(state.model(), family, test);
  }
  const ProjectedColumns projected = state.projector().project(moved);
  const Eigen::MatrixXd gram = projected.gram(0, count);
  const Eigen::VectorXd size = gram.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index k = 0; k < count; ++k) {
      if (i != k && size[i] * size[k] > 0.0)
        rivalry.cosine(i, k) = std::min(1.0, std::abs(gram(i, k)) / (size[i] * size[k]));
    }
  }
  return rivalry;
}

const std::vector<UnknownFinding>& Session::unknown() {
  scanned();
  return node().unknown;
}

bool Session::unknown_leads() {
  const ModelState& state = scanned();
  if (node().unknown.empty()) return false;
  const std::vector<std::size_t>& exceeding = state.tests().exceeding;
  return exceeding.empty() || any_scan_does_better(state, state.tests().families[exceeding.front()]);
}

EffectPreview Session::preview(const EffectName& effect) {
  const FamilyTest& test = test_of(effect);
  const ModelState& state = node().state;
  const Eigen::MatrixXd columns =
      family_columns(state.model(), state.setting().families[test.family], test.shape);
  const Eigen::VectorXd imitated = state.projector().imitation(columns) * test.score.amplitude;
  Eigen::Index at = state.model().problem().jacobian.cols();
  Eigen::VectorXd residual = this->residual() - columns * test.score.amplitude +
                             state.model().problem().jacobian * imitated.head(at);
  for (const AddedEffect& added : state.added()) {
    residual += added.columns * imitated.segment(at, added.columns.cols());
    at += added.columns.cols();
  }
  const double rms = rms_of_heldout(state, residual);
  return {finding(state.setting(), test), std::move(residual), rms};
}

Eigen::VectorXd Session::driver(const EffectName& effect) {
  const FamilyTest& test = test_of(effect);
  const ModelState& state = node().state;
  return family_columns(state.model(), state.setting().families[test.family], test.shape).rowwise().sum();
}

EffectPreview Session::formula(const EffectSpec& custom) {
  const EffectKind* kind = find_effect(custom.kind);
  if (kind == nullptr) throw std::invalid_argument(custom.kind + " is no kind of effect");
  const auto effect = kind->make(custom, {});
  effect->check(campaign(), {});
  tests();  // so that the new one is tested after the others, whatever was asked before
  const EffectName name = effect->name();
  const auto is_it = [&](const EffectSpec& spec) {
    return find_effect(spec.kind)->make(spec, {})->name() == name;
  };
  if (std::ranges::none_of(own_, is_it)) own_.push_back(custom);
  return preview(name);
}

SelectionSummary Session::summary(const std::vector<bool>& selected) const {
  const Eigen::VectorXd& left = residual();
  const std::vector<double> variance =
      noise_variance(node().state.model().problem().data, node().state.noise());
  SelectionSummary out;
  double sum = 0.0, variances = 0.0, positive = 0.0;
  for (std::size_t i = 0; i < std::min(selected.size(), variance.size()); ++i) {
    if (!selected[i] || !std::isfinite(variance[i])) continue;
    const double value = left[static_cast<Eigen::Index>(i)];
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
  next.effects.push_back(finding(next.state.setting(), test));
  next.becomes(next.state.with_at_this_noise(test));
  return append(current_, std::move(next), "+ " + label, ModelStanding::Preview);
}

/// Throws std::invalid_argument.
std::size_t Session::place_of(const EffectName& effect) const {
  const std::vector<EffectFinding>& effects = node().effects;
  const auto found = std::ranges::find(effects, effect, &EffectFinding::name);
  if (found == effects.end()) throw std::invalid_argument(full_name(effect) + " was not added to this model");
  return static_cast<std::size_t>(found - effects.begin());
}

bool Session::is_preview(const EffectName& effect) const { return place_of(effect) >= node().in_base(); }

const SessionModel& Session::remove_preview(const EffectName& effect) {
  const std::size_t place = place_of(effect);
  const Node& here = node();
  if (place < here.in_base()) throw std::invalid_argument(full_name(effect) + " is part of a full fit");
  Node next = here;
  next.effects = without(here.effects, place);
  ModelState state = here.base->state.with_setting(here.state.shared_setting());
  for (std::size_t i = 0; i < here.state.added().size(); ++i) {
    if (i != place - here.in_base()) state = state.with_at_this_noise(here.state.added()[i].test);
  }
  next.becomes(std::move(state));
  const auto standing = next.state.added().empty() ? ModelStanding::Fitted : ModelStanding::Preview;
  return append(current_, std::move(next), "- " + here.effects[place].label, standing);
}

/// A full fit of the given model with these effects.
SessionWork Session::fit_of(const std::shared_ptr<const Campaign>& campaign,
                            const std::vector<EffectFinding>& effects, const std::string& change) const {
  const ModelSpec model = extended_model(given_, *campaign, effects);
  return [=, fit_it = fitting(), parent = current_](const SessionProgress& progress) {
    return appending(parent, Node(fit_it(campaign, model, progress), effects), change);
  };
}

SessionWork Session::removal(const EffectName& effect) const {
  const std::size_t place = place_of(effect);
  return fit_of(node().base->campaign, without(node().effects, place), "- " + node().effects[place].label);
}

SessionWork Session::confirmation(std::size_t number) const {
  const auto campaign = nodes_.at(number)->base->campaign;
  return [fit_it = fitting(), campaign, model = extended_model(given_, *campaign, models_[number].effects),
          number](const SessionProgress& progress) -> SessionChange {
    const std::shared_ptr<const Fitted> base = fit_it(campaign, model, progress);
    return [base, number](Session& session) {
      SessionModel& shown = session.models_[number];
      Node& here = *session.nodes_[number];
      if (shown.standing != ModelStanding::Preview) return;
      for (std::size_t i = here.in_base(); i < here.effects.size() && !shown.contradiction; ++i)
        shown.contradiction =
            contradiction_of(shown.effects[i], fitted_finding(here.effects[i], base->result));
      session.put_in_place(base);
      here.base = base;
      here.becomes(base->state);
      shown.standing = shown.contradiction ? ModelStanding::Contradicted : ModelStanding::Fitted;
      session.describe(here, shown);
    };
  };
}

SessionWork Session::drawing(std::size_t which) {
  const UnknownFinding wanted = unknown().at(which);
  return [wanted, state = scanned(), number = current_](const SessionProgress& progress) -> SessionChange {
    report(progress, "a surface for what has no name", 0.1);
    const std::optional<SurfaceTest> test = best_surface(state, {wanted});
    if (!test) throw std::invalid_argument("no surface explains what depends on " + wanted.dependence());
    report(progress, "noise with the surface", 0.4);
    const ModelState with = state.with_surface(*test, state.added()).tested();
    report(progress, "laws behind it", 0.8);
    SurfaceFinding drawn = surface_findings(with).back();
    report(progress, "done", 1.0);
    return [drawn = std::move(drawn), number](Session& session) {
      std::vector<SurfaceFinding>& known = session.nodes_[number]->drawn;
      std::erase_if(known, [&](const SurfaceFinding& each) { return each.name == drawn.name; });
      known.push_back(drawn);
    };
  };
}

const std::vector<SurfaceFinding>& Session::drawn() const { return node().drawn; }

SessionWork Session::surface(const EffectName& name) const {
  const auto found = std::ranges::find(node().drawn, name, &SurfaceFinding::name);
  if (found == node().drawn.end()) throw std::invalid_argument(full_name(name) + " was not drawn");
  EffectFinding added;
  added.name = found->name;
  added.label = found->label;
  added.spec = found->spec;
  return fit_of(node().base->campaign, with(current().effects, std::move(added)), "+ " + found->label);
}

SessionWork Session::leaving_out(const std::vector<bool>& selected, const std::string& reason) const {
  auto campaign = std::make_shared<Campaign>(this->campaign());
  const std::size_t count = leave_out(linear(), selected, reason, *campaign);
  if (count == 0) throw std::invalid_argument("no reading is marked that is not left out already");
  return fit_of(campaign, current().effects,
                "- " + std::to_string(count) + (count == 1 ? " reading: " : " readings: ") + reason);
}

SessionWork Session::climb() const {
  return [fit_it = fitting(), campaign = node().base->campaign, given = given_, model = model(),
          effects = current().effects, parent = current_](const SessionProgress& progress) -> SessionChange {
    DiagnoseOptions options;
    options.threads = fit_it.options.threads;
    options.climb = true;
    options.heldout_share = fit_it.options.heldout_share;
    options.own = fit_it.own;
    options.figures = options.compare = false;
    options.progress = [&](const std::string& stage, double done) {
      report(progress, stage, kShareOfSearch * done);
    };
    const std::vector<EffectFinding> found =
        accepted_effects(diagnose_model(*campaign, model, options).diagnosis);
    std::vector<SessionChange> changes;
    std::vector<EffectFinding> all = effects;
    Fitting fit_next = fit_it;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const double from = kShareOfSearch +
                          (1.0 - kShareOfSearch) * static_cast<double>(i) / static_cast<double>(found.size());
      const SessionProgress part = [&](const std::string& stage, double /*done*/) {
        return !progress || progress(found[i].label + ": " + stage, from);
      };
      all.push_back(found[i]);
      const auto base = fit_next(campaign, extended_model(given, *campaign, all), part);
      fit_next.before.push_back(base->state);
      fit_next.least_variance = std::min(fit_next.least_variance, base->noise_variance);
      changes.push_back(
          [made = Node(base, all), change = "+ " + found[i].label, parent, first = i == 0](Session& session) {
            appending(first ? parent : session.current_, made, change)(session);
          });
    }
    return [changes = std::move(changes)](Session& session) {
      for (const SessionChange& change : changes) change(session);
    };
  };
}

const SessionModel& Session::take(const SessionWork& work, const SessionProgress& progress) {
  work(progress)(*this);
  return current();
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

ModelSpec Session::model() const { return extended_model(given_, campaign(), current().effects); }

}  // namespace volcal
