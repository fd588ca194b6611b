#include "volcal/identify/session/session.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/diagnosis.h"
#include "volcal/identify/criticism/effect_findings.h"
#include "volcal/identify/criticism/model_extension.h"
#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/criticism/search/model_tests.h"
#include "volcal/identify/criticism/search/search.h"
#include "volcal/identify/criticism/search/surface_search.h"
#include "volcal/identify/criticism/search/unknown_findings.h"
#include "volcal/identify/criticism/surface_findings.h"
#include "volcal/identify/numeric/interruption.h"
#include "volcal/identify/numeric/threads.h"
#include "volcal/identify/session/hidden_effects.h"
#include "volcal/identify/session/proposed_measurements.h"
#include "volcal/identify/session/session_tree.h"
#include "volcal/identify/statistics/normal.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kContradiction = 0.25;       // of U95: a preview that is off by more was wrong
constexpr double kShareOfSearch = 0.8;        // of the time of a climb
constexpr std::size_t kPreviewedAtOnce = 12;  // of the ranking
constexpr std::size_t kPrepared = 2;          // of the ranking
constexpr std::size_t kPreparedOfMany = 1;    // 15 s of a processor and 600 MB at 10^5 readings
constexpr std::size_t kManyReadings = 30000;
constexpr std::size_t kKeptFigures = 2;  // of models: 100 to 200 MB at 10^5 readings each
constexpr std::size_t kKeptModels = 8;   // linear models in memory; those of previews share a full fit's

void report(const SessionProgress& progress, const std::string& stage, double done) {
  if (progress && !progress(stage, done)) throw SessionStopped("stopped at: " + stage);
}

/// Work that is stopped wherever it is, between two items that threads take, not between its stages alone.
SessionWork interruptible(SessionWork work) {
  return [work = std::move(work)](const SessionProgress& progress) {
    if (!progress) return work(progress);
    std::string stage = "begin";
    double share = 0.0;
    const SessionProgress followed = [&](const std::string& now, double done) {
      stage = now;
      share = done;
      return progress(now, done);
    };
    const Interruption guard([&] { report(progress, stage, share); });
    return work(followed);
  };
}

std::vector<EffectFinding> with(std::vector<EffectFinding> effects, EffectFinding more) {
  effects.push_back(std::move(more));
  return effects;
}

std::vector<EffectFinding> without(std::vector<EffectFinding> effects, std::size_t place) {
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(place));
  return effects;
}

/// By a full fit, which a linear preview should have foreseen; the amplitude that is off by most of its U.
std::optional<Contradiction> contradiction_of(ModelStanding of, const EffectFinding& preview,
                                              const EffectFinding& fitted) {
  std::optional<Contradiction> worst;
  double most = kContradiction * kCoverageFactor;
  for (std::size_t k = 0; k < std::min(preview.amplitudes.size(), fitted.amplitudes.size()); ++k) {
    const AmplitudeFigure& before = preview.amplitudes[k];
    const AmplitudeFigure& after = fitted.amplitudes[k];
    const double miss = std::abs(before.value - after.value);
    if (miss <= most * after.u) continue;
    most = miss / after.u;
    worst = {of, after.label, before.value, after.value, after.u, after.unit, after.si_per_unit};
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

EffectName name_of(const EffectSpec& spec) { return find_effect(spec.kind)->make(spec, {})->name(); }

/// No test was made of it when it came into the model.
void be_untested(EffectFinding& effect) {
  effect.log10_p = effect.gain = effect.visible_fraction = std::numeric_limits<double>::quiet_NaN();
}

std::vector<EffectFinding> given_effects(const ModelSpec& model) {
  std::vector<EffectFinding> effects;
  for (const EffectSpec& spec : model.effects) {
    const auto effect = find_effect(spec.kind)->make(spec, {});
    EffectFinding& given = effects.emplace_back();
    given.name = effect->name();
    given.label = effect_label(*effect);
    given.spec = spec;
    be_untested(given);
  }
  return effects;
}

/// The given model with those of its effects that are listed, as they were given, and with the others.
ModelSpec model_with(ModelSpec given, const Campaign& campaign, std::vector<EffectFinding> effects) {
  std::erase_if(given.effects, [&](const EffectSpec& spec) {
    const EffectName name = name_of(spec);
    return std::erase_if(effects, [&](const EffectFinding& effect) { return effect.name == name; }) == 0;
  });
  return extended_model(std::move(given), campaign, effects);
}

void require_not_in_model(const std::vector<EffectFinding>& effects, const EffectName& name) {
  const auto known = std::ranges::find(effects, name, &EffectFinding::name);
  if (known == effects.end()) return;
  throw InputError({}, "the model has " + known->label + " already",
                   "take it out first; a second one with a parameter that is estimated is written with "
                   "another letter, q in place of p");
}

bool have_same_values(const EffectSpec& one, const EffectSpec& other) {
  constexpr std::array kValues = {"p", "p_sigma", "q", "q_sigma"};
  return std::ranges::all_of(
      kValues, [&](const char* key) { return one.options.number(key) == other.options.number(key); });
}

/// Parameters that the readings in use determine, and no fewer readings than these and one.
void require_readings(const Session& session, const std::vector<bool>& selected) {
  const FitResult& result = session.fitted_result();
  const std::vector<double>& sigma = session.linear().problem().data.sigma;
  std::size_t before = 0, remaining = 0;
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    if (!std::isfinite(sigma[i])) continue;
    ++before;
    if (i >= selected.size() || !selected[i]) ++remaining;
  }
  const double parameters = std::max(0.0, static_cast<double>(before) - result.dof);
  if (static_cast<double>(remaining) > parameters) return;
  const std::string what = remaining == 0   ? "no reading would remain"
                           : remaining == 1 ? "1 reading would remain"
                                            : std::to_string(remaining) + " readings would remain";
  throw InputError({},
                   what + ", and this model needs more than " +
                       std::to_string(static_cast<long long>(std::ceil(parameters))),
                   "leave out fewer readings, or begin with a model of fewer errors");
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

Session::Session(Campaign campaign, ModelSpec model, SessionOptions options)
    : options_(std::move(options)), given_(std::move(model)) {
  options_.threads = thread_count(options_.threads);
  const auto shared = std::make_shared<const Campaign>(std::move(campaign));
  const SessionWork load = interruptible([this, shared](const SessionProgress& progress) {
    return appending(0, fitting(shared)(shared, given_, progress), given_effects(given_), "");
  });
  load(options_.progress)(*this);
}

Session::~Session() = default;

namespace {

constexpr auto readings_of = [](const auto& fitted) { return fitted->campaign(); };

}  // namespace

Session::Fitting Session::fitting(const std::shared_ptr<const Campaign>& campaign) const {
  std::vector<Recipe> before;
  for (const auto& node : nodes_) before.push_back(node->recipe);
  const auto least = std::ranges::find(least_, campaign, readings_of);
  return {options_, own_, std::move(before),
          least != least_.end() ? (*least)->noise_variance() : std::numeric_limits<double>::max()};
}

/// Of the least noise at the readings of a model.
const std::shared_ptr<const Session::Fitted>& Session::least_of(const Recipe& recipe) const {
  return *std::ranges::find(least_, recipe.base->campaign(), readings_of);
}

/// Noise that was estimated without an effect holds part of it and hides its fall, so that all models are
/// told against the least noise that a full fit of the same readings has found.
void Session::put_in_place(const FittedModel& found) {
  const auto known = std::ranges::find(least_, found.fitted->campaign(), readings_of);
  if (known == least_.end()) {
    least_.push_back(found.fitted);
  } else if (found.fitted->noise_variance() < (*known)->noise_variance()) {
    *known = found.fitted;
  } else {
    return;
  }
  for (std::size_t i = 0; i < std::min(found.figures.size(), models_.size()); ++i) {
    if (found.figures[i]) set_figures(*found.figures[i], models_[i]);
  }
}

/// Another model is the current one. Of those that were looked at longest ago nothing stays that can be made
/// again.
void Session::go(std::size_t number) {
  current_ = number;
  std::erase(recent_, number);
  recent_.insert(recent_.begin(), number);
  std::vector<const Fitted*> kept;
  std::size_t models = 0;
  for (const std::size_t each : recent_) {
    Node& of = *nodes_[each];
    if (each != number) of.forget_prepared();
    const Fitted* base = of.recipe.base.get();
    const bool known = std::ranges::find(kept, base) != kept.end();
    if (++models <= kKeptModels && (known || kept.size() < kKeptFits)) {
      if (!known) kept.push_back(base);
      continue;
    }
    of.let_go();
    if (!known) base->let_go();
  }
}

std::size_t Session::kept_fits() const {
  std::vector<const Fitted*> kept;
  for (const auto& node : nodes_) {
    const Fitted* base = node->recipe.base.get();
    if (base->is_kept() && std::ranges::find(kept, base) == kept.end()) kept.push_back(base);
  }
  return kept.size();
}

void Session::set_figures(LadderStep figures, SessionModel& shown) {
  shown.figures = std::move(figures);
  shown.figures.model = std::to_string(shown.number);
  shown.figures.added = shown.change;
}

const Campaign& Session::campaign() const { return *node().recipe.base->campaign(); }
const std::vector<SessionModel>& Session::models() const { return models_; }
const SessionModel& Session::current() const { return models_[current_]; }
const LinearModel& Session::linear() const { return node().state().model(); }
const std::vector<bool>& Session::heldout() const { return node().recipe.setting->heldout; }
const FitResult& Session::fitted_result() const { return node().recipe.base->result(); }

const Eigen::VectorXd& Session::residual(std::size_t model) const {
  Node& of = *nodes_.at(model);
  if (!of.residual) of.residual = of.state().residual();
  return *of.residual;
}

Eigen::VectorXd Session::sigma(std::size_t model) const {
  const std::vector<double>& variance = nodes_.at(model)->recipe.variance();
  return Eigen::Map<const Eigen::VectorXd>(variance.data(), static_cast<Eigen::Index>(variance.size()))
      .cwiseSqrt();
}

const SessionModel& Session::append(std::size_t parent, std::unique_ptr<Node> made, std::string change,
                                    ModelStanding standing) {
  SessionModel shown;
  shown.number = models_.size();
  if (!models_.empty()) shown.parent = parent;
  shown.change = std::move(change);
  shown.standing = standing;
  describe(*made, shown);
  nodes_.push_back(std::move(made));
  models_.push_back(std::move(shown));
  visited_.clear();
  undone_.clear();
  go(models_.size() - 1);
  return models_.back();
}

SessionChange Session::appending(std::size_t parent, FittedModel found, std::vector<EffectFinding> effects,
                                 std::string change) {
  return [parent, found = std::move(found), effects = std::move(effects),
          change = std::move(change)](Session& session) {
    session.put_in_place(found);
    session.append(parent, std::make_unique<Node>(found.fitted, effects), change, ModelStanding::Fitted);
  };
}

void Session::describe(Node& made, SessionModel& shown) {
  const KeptFigures& figures = figures_of(made.recipe);
  const auto& least = least_of(made.recipe);
  if (made.recipe.base == least && !made.recipe.refit) {
    set_figures(figures.last_step(made.state(), made.state().projector()), shown);
  } else {
    if (made.least != least) {
      made.at_least = made.recipe.projector_at(*least, made.state());
      made.least = least;
    }
    set_figures(figures.last_step(made.state(), *made.at_least), shown);
  }
  shown.effects.clear();
  for (std::size_t i = 0; i < made.in_base(); ++i)
    shown.effects.push_back(made.recipe.base->fitted(made.effects[i]));
  if (made.recipe.added.empty()) return;
  for (EffectFinding& added : added_findings(made.state(), *made.of_all_readings()))
    shown.effects.push_back(std::move(added));
}

/// Of the recipe's model without added effects, against the least noise.
const KeptFigures& Session::figures_of(const Recipe& recipe) {
  const auto& least = least_of(recipe);
  const auto known =
      std::ranges::find_if(kept_figures_, [&](const auto& each) { return each->is_of(recipe, least); });
  auto found = known != kept_figures_.end() ? *known : nullptr;
  std::erase(kept_figures_, found);
  if (kept_figures_.size() >= kKeptFigures) kept_figures_.pop_back();
  if (!found) found = FiguresOfModel::of(recipe, least);
  kept_figures_.insert(kept_figures_.begin(), found);
  return found->figures;
}

/// With the effects that the user thought of meanwhile.
void Session::renew_setting() {
  Node& here = node();
  const SearchSetting& known = *here.recipe.setting;
  if (known.own == own_.size()) return;
  const std::vector<EffectSpec> more(own_.begin() + static_cast<std::ptrdiff_t>(known.own), own_.end());
  here.with_setting(std::make_shared<const SearchSetting>(known.with_more(here.state().model(), more)));
}

/// Tests of all effects at the current model.
const std::vector<FamilyTest>& Session::tests() {
  renew_setting();
  return node().tests->get().families;
}

std::function<void()> Session::testing() {
  renew_setting();
  return [tests = node().tests] { tests->get(); };
}

SessionWork Session::scan() {
  renew_setting();
  return interruptible([recipe = node().recipe, state = node().state(), tests = node().tests,
                        number = current_](const SessionProgress& progress) -> SessionChange {
    report(progress, "tests of the catalogue", 0.1);
    const std::vector<FamilyTest>& families = tests->get().families;
    report(progress, "scans without a catalogue", 0.3);
    const ModelState scanned = state.with_tests(tests_of(state, families));
    std::vector<UnknownFinding> unknown = unknown_findings(scanned, {});
    report_what_is_certain(unknown);
    const std::vector<std::size_t>& exceeding = scanned.tests().exceeding;
    const bool leads =
        !unknown.empty() &&
        (exceeding.empty() || any_scan_does_better(scanned, scanned.tests().families[exceeding.front()]));
    report(progress, "what to measure next", 0.9);
    std::vector<MeasurementProposal> proposals = proposed_measurements(scanned, recipe.base->result());
    report(progress, "done", 1.0);
    return [scanned, unknown = std::move(unknown), leads, proposals = std::move(proposals),
            base = recipe.base, refit = recipe.refit, number](Session& session) {
      Node& of = *session.nodes_[number];
      if (of.recipe.base != base || of.recipe.refit != refit) return;  // refitted or confirmed meanwhile
      of.scanned = scanned;
      of.unknown = unknown;
      of.unknown_leads = leads;
      of.proposals = proposals;
    };
  });
}

bool Session::is_scanned() const { return node().unknown.has_value(); }

/// With the scans.
const ModelState& Session::scanned() {
  renew_setting();
  if (!node().scanned) scan()({})(*this);
  return *node().scanned;
}

/// The last of a name: of a formula that was written again with other values the one that is asked for now.
const FamilyTest& Session::test_of(const EffectName& effect) {
  const std::vector<FamilyTest>& all = tests();
  for (std::size_t i = all.size(); i-- > 0;) {
    const Family& family = node().state().setting().families[all[i].family];
    if (family.effect && family.name() == effect && !node().state().has(all[i].family)) return all[i];
  }
  throw std::invalid_argument(full_name(effect) + " is no effect that can be added to this model");
}

namespace {

/// Whether a formula was written again, by the same name with other values.
bool is_written_again(const SearchSetting& setting, std::size_t family) {
  const std::size_t listed = setting.families.size() - setting.own;
  if (family < listed) return false;
  const EffectName name = setting.families[family].name();
  return std::any_of(setting.families.begin() + static_cast<std::ptrdiff_t>(family) + 1,
                     setting.families.end(), [&](const Family& later) { return later.name() == name; });
}

}  // namespace

/// What shows and is not in the model, best first.
std::vector<const FamilyTest*> Session::ranked() {
  std::vector<const FamilyTest*> order;
  for (const FamilyTest& test : tests()) {
    if (test.score.dof > 0 && !node().state().has(test.family) &&
        !is_written_again(*node().recipe.setting, test.family))
      order.push_back(&test);
  }
  sort_by_gain(order);
  return order;
}

const std::vector<EffectFinding>& Session::rank() {
  const std::vector<const FamilyTest*> order = ranked();
  Node& here = node();
  if (!here.ranking) {
    std::vector<EffectFinding> ranking;
    for (const FamilyTest* test : order) ranking.push_back(finding(here.state().setting(), *test));
    here.ranking = std::move(ranking);
  }
  return *here.ranking;
}

std::vector<EffectFinding> Session::not_visible() {
  std::vector<EffectFinding> hidden;
  for (const FamilyTest& test : tests()) {
    if (test.score.dof == 0 && !node().state().has(test.family) &&
        !is_written_again(*node().recipe.setting, test.family))
      hidden.push_back(finding(node().state().setting(), test));
  }
  return hidden;
}

std::vector<Explanation> Session::why_not_visible(const std::vector<EffectFinding>& effects) {
  std::map<EffectName, Explanation>& known = node().why_not_visible;
  std::vector<const FamilyTest*> asked;
  for (const EffectFinding& effect : effects) {
    if (!known.contains(effect.name)) asked.push_back(&test_of(effect.name));
  }
  const std::vector<Explanation> found = why_hidden(node().state(), asked);
  for (std::size_t i = 0; i < asked.size(); ++i)
    known[node().recipe.setting->families[asked[i]->family].name()] = found[i];
  std::vector<Explanation> all;
  for (const EffectFinding& effect : effects) all.push_back(known.at(effect.name));
  return all;
}

Rivalry Session::rivals(std::size_t most) {
  std::vector<const FamilyTest*> leading = ranked();
  std::erase_if(leading, [&](const FamilyTest* test) {
    return node().state().setting().families[test->family].effect == nullptr;
  });
  leading.resize(std::min(leading.size(), most));
  const ModelState& state = node().state();
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
  if (!is_scanned()) scanned();
  return *node().unknown;
}

bool Session::unknown_leads() {
  if (!is_scanned()) scanned();
  return node().unknown_leads;
}

const std::vector<MeasurementProposal>& Session::next_measurements() {
  if (!is_scanned()) scanned();
  return node().proposals;
}

namespace {

/// Residuals if each of the families were added, its amplitudes as tested and the rest of the model adjusted;
/// a column each.
Eigen::MatrixXd residuals_with(const ModelState& state, const Eigen::VectorXd& before,
                               const std::vector<const FamilyTest*>& tests) {
  const LinearModel& model = state.model();
  Eigen::MatrixXd moved(static_cast<Eigen::Index>(model.size()), static_cast<Eigen::Index>(tests.size()));
  for (std::size_t k = 0; k < tests.size(); ++k)
    moved.col(static_cast<Eigen::Index>(k)) =
        displacement(model, state.setting().families[tests[k]->family], *tests[k]);
  const Eigen::MatrixXd imitated = state.projector().imitation(moved);
  Eigen::Index at = model.problem().jacobian.cols();
  Eigen::MatrixXd change = moved;
  Eigen::MatrixXd by_model = Eigen::MatrixXd::Zero(moved.rows(), moved.cols());
  by_model.noalias() += model.problem().jacobian * imitated.topRows(at);
  change -= by_model;
  for (const AddedEffect& added : state.added()) {
    change -= added.columns * imitated.middleRows(at, added.columns.cols());
    at += added.columns.cols();
  }
  return (-change).colwise() + before;
}

}  // namespace

/// Of the leading effects of the catalogue, made together: one pass over the model's columns.
void Session::preview_leading() {
  std::vector<const FamilyTest*> leading = ranked();
  const std::vector<Family>& families = node().recipe.setting->families;
  const std::size_t listed = families.size() - node().recipe.setting->own;
  std::erase_if(leading, [&](const FamilyTest* test) {
    return families[test->family].effect == nullptr || test->family >= listed;
  });
  leading.resize(std::min(leading.size(), kPreviewedAtOnce));
  if (leading.empty() || node().previewed.contains(families[leading.front()->family].name())) return;
  const Eigen::MatrixXd residuals = residuals_with(node().state(), residual(), leading);
  for (std::size_t k = 0; k < leading.size(); ++k)
    node().previewed[families[leading[k]->family].name()] = residuals.col(static_cast<Eigen::Index>(k));
}

Eigen::VectorXd Session::previewed_residual(const FamilyTest& test) {
  preview_leading();
  const EffectName name = node().recipe.setting->families[test.family].name();
  if (const auto known = node().previewed.find(name); known != node().previewed.end()) return known->second;
  return residuals_with(node().state(), residual(), {&test}).col(0);
}

EffectPreview Session::preview(const EffectName& effect) {
  const FamilyTest& test = test_of(effect);
  Eigen::VectorXd residual = previewed_residual(test);
  const double rms = rms_of_heldout(node().state(), residual);
  return {finding(*node().recipe.setting, test), std::move(residual), rms};
}

Eigen::VectorXd Session::driver(const EffectName& effect) {
  const FamilyTest& test = test_of(effect);
  const ModelState& state = node().state();
  return family_columns(state.model(), state.setting().families[test.family], test.shape).rowwise().sum();
}

EffectPreview Session::formula(const EffectSpec& custom) {
  const EffectKind* kind = find_effect(custom.kind);
  if (kind == nullptr) throw std::invalid_argument(custom.kind + " is no kind of effect");
  const auto effect = kind->make(custom, {});
  const EffectName name = effect->name();
  effect->check(campaign(), {});
  require_not_in_model(node().effects, name);
  require_drivers(custom, *effect);
  tests();  // so that the new one is tested after the others, whatever was asked before
  const auto last =
      std::find_if(own_.rbegin(), own_.rend(), [&](const EffectSpec& spec) { return name_of(spec) == name; });
  if (last != own_.rend() && have_same_values(*last, custom)) return preview(name);
  own_.push_back(custom);
  try {
    renew_setting();
  } catch (...) {
    own_.pop_back();
    throw;
  }
  return preview(name);
}

/// Throws InputError where they are not finite, or so large that their products are not.
void Session::require_drivers(const EffectSpec& custom, const Effect& effect) const {
  const Eigen::VectorXd sigma = this->sigma(current_);
  const std::vector<Family> written = own_families(linear(), std::span(&custom, 1));
  const Eigen::MatrixXd columns = family_columns(linear(), written.front(), effect.shape_values());
  const double squares = (columns.array().colwise() / sigma.array()).square().sum();
  if (!std::isfinite(squares * squares))
    throw InputError({}, effect_label(effect) + " moves the readings by more than can be computed",
                     "write it with smaller numbers, about 1 where it acts most");
}

SelectionSummary Session::summary(const std::vector<bool>& selected) const {
  const Eigen::VectorXd& left = residual();
  const std::vector<double>& variance = node().recipe.variance();
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

/// The current model with an effect more: what is prepared, or made here.
std::shared_ptr<const Session::Node> Session::node_with(const FamilyTest& test) {
  const Node& here = node();
  const SearchSetting& setting = *here.recipe.setting;
  const auto known = here.prepared.find(setting.families[test.family].name());
  if (known != here.prepared.end()) return known->second;
  return std::make_shared<const Node>(here.with(test, finding(setting, test)));
}

SessionWork Session::preparation() {
  renew_setting();
  const SearchSetting& setting = *node().recipe.setting;
  const std::size_t most = linear().size() > kManyReadings ? kPreparedOfMany : kPrepared;
  std::map<EffectName, std::shared_ptr<const Node>> ahead;
  for (const FamilyTest* test : ranked()) {
    if (ahead.size() == most || setting.family_wise_log10_p(*test) > log10_family_risk()) break;
    const Family& family = setting.families[test->family];
    if (!family.effect) continue;
    std::shared_ptr<const Node> next = node_with(*test);
    next->shared_refit(least_of(next->recipe));
    ahead.emplace(family.name(), std::move(next));
  }
  node().prepared = ahead;
  return interruptible([ahead = std::move(ahead), least = least_of(node().recipe), base = node().recipe.base,
                        setting = node().recipe.setting,
                        number = current_](const SessionProgress& progress) -> SessionChange {
    double done = 0.0;
    for (const auto& [effect, next] : ahead) {
      report(progress, next->effects.back().label, done);
      next->shared_refit(least)->get(progress).tests->get_unless_stopped();
      done += 1.0 / static_cast<double>(ahead.size());
    }
    return [base, setting, number](Session& session) {
      Node& of = *session.nodes_[number];
      if (session.current_ == number && of.recipe.base == base && of.recipe.setting == setting)
        of.is_prepared = true;
    };
  });
}

bool Session::is_prepared() const { return node().is_prepared; }

const SessionModel& Session::add(const EffectName& effect) {
  const FamilyTest& test = test_of(effect);
  if (test.score.dof == 0) {
    const EffectFinding hidden = finding(*node().recipe.setting, test);
    const Explanation why = why_not_visible({hidden}).front();
    throw InputError({}, hidden.label + " is not visible: " + why.reason, why.remedy);
  }
  const std::string change = "+ " + node().recipe.setting->families[test.family].label();
  return append(current_, std::make_unique<Node>(*node_with(test)), change, ModelStanding::Preview);
}

/// Throws std::invalid_argument.
std::size_t Session::place_of(const EffectName& effect) const {
  const std::vector<EffectFinding>& effects = node().effects;
  const auto found = std::ranges::find(effects, effect, &EffectFinding::name);
  if (found == effects.end()) throw std::invalid_argument(full_name(effect) + " is not in this model");
  return static_cast<std::size_t>(found - effects.begin());
}

bool Session::is_preview(const EffectName& effect) const { return place_of(effect) >= node().in_base(); }

const SessionModel& Session::remove_preview(const EffectName& effect) {
  const std::size_t place = place_of(effect);
  const Node& here = node();
  if (place < here.in_base()) throw std::invalid_argument(full_name(effect) + " is part of a full fit");
  auto next = std::make_unique<Node>(here.recipe.base, without(here.effects, place));
  Recipe recipe = here.recipe;
  recipe.added.erase(recipe.added.begin() + static_cast<std::ptrdiff_t>(place - here.in_base()));
  recipe.refit = nullptr;  // its noise was found with the effect
  next->becomes(std::move(recipe));
  const auto standing = next->recipe.added.empty() ? ModelStanding::Fitted : ModelStanding::Preview;
  return append(current_, std::move(next), "- " + here.effects[place].label, standing);
}

bool Session::was_given(const EffectName& effect) const {
  return std::ranges::any_of(given_.effects, [&](const EffectSpec& spec) { return name_of(spec) == effect; });
}

/// A full fit with these effects, those of the given model among them.
SessionWork Session::fit_of(const std::shared_ptr<const Campaign>& campaign,
                            const std::vector<EffectFinding>& effects, const std::string& change) const {
  const ModelSpec model = model_with(given_, *campaign, effects);
  return interruptible([=, fit_it = fitting(campaign), parent = current_](const SessionProgress& progress) {
    return appending(parent, fit_it(campaign, model, progress), effects, change);
  });
}

SessionWork Session::removal(const EffectName& effect) const {
  const std::size_t place = place_of(effect);
  return fit_of(node().recipe.base->campaign(), without(node().effects, place),
                "- " + node().effects[place].label);
}

SessionWork Session::confirmation(std::size_t number) const {
  const auto campaign = nodes_.at(number)->recipe.base->campaign();
  return interruptible([fit_it = fitting(campaign), campaign,
                        model = model_with(given_, *campaign, models_[number].effects),
                        number](const SessionProgress& progress) -> SessionChange {
    const FittedModel found = fit_it(campaign, model, progress);
    return [found, number](Session& session) {
      SessionModel& shown = session.models_[number];
      Node& here = *session.nodes_[number];
      if (!awaits_full_fit(shown.standing)) return;
      for (std::size_t i = here.in_base(); i < here.effects.size() && !shown.contradiction; ++i)
        shown.contradiction =
            contradiction_of(shown.standing, shown.effects[i], found.fitted->fitted(here.effects[i]));
      session.put_in_place(found);
      here.becomes({found.fitted, found.fitted->setting(), {}});
      shown.standing = shown.contradiction ? ModelStanding::Contradicted : ModelStanding::Fitted;
      session.describe(here, shown);
      session.go(session.current_);
    };
  });
}

SessionWork Session::refit(std::size_t number) const {
  const Node& of = *nodes_.at(number);
  return interruptible([base = of.recipe.base, changes = !of.recipe.added.empty(),
                        refit = of.shared_refit(least_of(of.recipe)),
                        number](const SessionProgress& progress) -> SessionChange {
    if (!changes) return [](Session&) {};
    report(progress, "noise with what was added", 0.1);
    const RefittedModel& found = refit->get(progress);
    report(progress, "done", 1.0);
    return [found, base, number](Session& session) {
      SessionModel& shown = session.models_[number];
      Node& here = *session.nodes_[number];
      if (shown.standing != ModelStanding::Preview || here.recipe.base != base) return;
      here.becomes(found);
      shown.standing = ModelStanding::Refitted;
      session.describe(here, shown);
    };
  });
}

namespace {

/// What a scan sees best as a rotation may be a displacement along its direction: both are drawn, and the
/// readings decide.
std::vector<UnknownFinding> along_and_as(const UnknownFinding& finding) {
  std::vector<UnknownFinding> both{finding};
  if (!finding.rotation) return both;
  both.push_back(finding);
  both.back().rotation.reset();
  return both;
}

}  // namespace

SessionWork Session::drawing(std::size_t which) {
  const UnknownFinding wanted = unknown().at(which);
  return interruptible(
      [wanted, state = scanned(), number = current_](const SessionProgress& progress) -> SessionChange {
        report(progress, "a surface for what has no name", 0.1);
        const std::optional<SurfaceTest> test = best_surface(state, along_and_as(wanted));
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
      });
}

const std::vector<SurfaceFinding>& Session::drawn() const { return node().drawn; }

SessionWork Session::surface(const EffectName& name) const {
  const auto found = std::ranges::find(node().drawn, name, &SurfaceFinding::name);
  if (found == node().drawn.end()) throw std::invalid_argument(full_name(name) + " was not drawn");
  EffectFinding added;
  added.name = found->name;
  added.label = found->label;
  added.spec = found->spec;
  be_untested(added);
  return fit_of(node().recipe.base->campaign(), with(current().effects, std::move(added)),
                "+ " + found->label);
}

SessionWork Session::leaving_out(const std::vector<bool>& selected, const std::string& reason) const {
  auto campaign = std::make_shared<Campaign>(this->campaign());
  const std::size_t count = leave_out(linear(), selected, reason, *campaign);
  if (count == 0) throw std::invalid_argument("no reading is marked that is not left out already");
  require_readings(*this, selected);
  return fit_of(campaign, current().effects,
                "- " + std::to_string(count) + (count == 1 ? " reading: " : " readings: ") + reason);
}

DiagnosisWork Session::diagnosis(DiagnoseOptions options) const {
  options.threads = options_.threads;
  options.heldout_share = options_.heldout_share;
  return [options = std::move(options), base = node().recipe.base, model = model(),
          is_fitted = !awaits_full_fit(current().standing)](const SessionProgress& progress) {
    DiagnoseOptions told = options;
    told.progress = [&](const std::string& stage, double done) { report(progress, stage, done); };
    if (!is_fitted) return diagnose_model(*base->campaign(), model, told);
    return DiagnosedModel{base->result(), diagnose(base->result(), base->state(), told)};
  };
}

SessionWork Session::climb() const {
  DiagnoseOptions options;
  options.climb = true;
  options.own = own_;
  options.figures = options.compare = false;
  return interruptible([diagnosis = diagnosis(options), fit_it = fitting(node().recipe.base->campaign()),
                        campaign = node().recipe.base->campaign(), given = given_,
                        effects = current().effects,
                        parent = current_](const SessionProgress& progress) -> SessionChange {
    const SessionProgress of_search = [&](const std::string& stage, double done) {
      return !progress || progress(stage, kShareOfSearch * done);
    };
    const std::vector<EffectFinding> found = accepted_effects(diagnosis(of_search).diagnosis);
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
      const FittedModel made = fit_next(campaign, model_with(given, *campaign, all), part);
      fit_next.before.push_back({made.fitted, made.fitted->setting(), {}});
      fit_next.least_variance = std::min(fit_next.least_variance, made.fitted->noise_variance());
      changes.push_back(
          [made, all, change = "+ " + found[i].label, parent, first = i == 0](Session& session) {
            appending(first ? parent : session.current_, made, all, change)(session);
          });
    }
    return [changes = std::move(changes)](Session& session) {
      for (const SessionChange& change : changes) change(session);
    };
  });
}

const SessionModel& Session::take(const SessionWork& work, const SessionProgress& progress) {
  work(progress)(*this);
  return current();
}

/// Back from a model that was gone to, else from what was made to what it was made of.
bool Session::undo() {
  if (!can_undo()) return false;
  undone_.push_back(current_);
  if (visited_.empty()) {
    go(*current().parent);
  } else {
    go(visited_.back());
    visited_.pop_back();
  }
  return true;
}

bool Session::redo() {
  if (undone_.empty()) return false;
  visited_.push_back(current_);
  go(undone_.back());
  undone_.pop_back();
  return true;
}

const SessionModel& Session::go_to(std::size_t number) {
  const SessionModel& wanted = models_.at(number);
  if (number != current_) visited_.push_back(current_);
  go(number);
  return wanted;
}

ModelSpec Session::model() const { return model_with(given_, campaign(), current().effects); }

}  // namespace volcal
