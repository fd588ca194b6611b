#include "volcal/identify/session/session_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/numeric/interruption.h"
#include "volcal/identify/session/session_work.h"
#include "volcal/identify/solve/adjustment.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/identify/solve/normals/datum.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

constexpr double kShareOfFit = 0.6;    // of the time of a full step
constexpr double kShareOfNoise = 0.9;  // with that of the noise
constexpr int kRefitSteps = 3;
constexpr double kMovedNoise = 0.1;  // of the variance: what the noise was found about is no more near

FitOptions fit_options(int threads, const SessionProgress& progress) {
  FitOptions options;
  options.threads = threads;
  options.outliers = OutlierPolicy::Remove;
  options.noise = NoisePolicy::White;  // found with the tests, as in a diagnosis
  options.progress = [progress](const std::string& stage, double done) {
    report_stage(progress, stage, kShareOfFit * done);
  };
  return options;
}

/// What others wait for is not stopped by the one who makes it, and asks nothing: who answers may be waiting.
struct UndisturbedLock {
  explicit UndisturbedLock(std::mutex& mutex) : lock(mutex) {}
  std::lock_guard<std::mutex> lock;
  Interruption::Share undisturbed{nullptr};
};

double mean_noise_variance(const ModelState& state) {
  double sum = 0.0, count = 0.0;
  for (const double variance : noise_variance(state.model().problem().data, state.noise())) {
    if (!std::isfinite(variance)) continue;
    sum += variance;
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

/// Of the mean over the readings in use.
double log_change(const std::vector<double>& before, const std::vector<double>& after) {
  double sum_before = 0.0, sum_after = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!std::isfinite(before[i]) || !std::isfinite(after[i])) continue;
    sum_before += before[i];
    sum_after += after[i];
  }
  return std::log(sum_after / sum_before);
}

}  // namespace

Session::Fitted::Fitted(std::shared_ptr<const Campaign> campaign, FitResult result, ModelState state)
    : campaign_(std::move(campaign)),
      result_(std::move(result)),
      setting_(state.shared_setting()),
      noise_estimate_(state.noise_estimate()),
      noise_(state.noise()),
      smoothing_(state.model().smoothing()),
      variance_(volcal::noise_variance(state.model().problem().data, state.noise())),
      noise_variance_(mean_noise_variance(state)),
      kept_(std::move(state)) {
  find_values();
}

/// Of all parameters at the noise and smoothing of the state: the fit itself takes the readings as
/// independent.
void Session::Fitted::find_values() {
  const auto projector = projector_of_all_readings();
  const DatumSpace datum(result_.layout, campaign_->machine, result_.parameters);
  values_ = datum.raw(result_.adjustment->reduced + projector->solution());
}

ModelState Session::Fitted::state() const {
  const UndisturbedLock lock(mutex_);
  if (!kept_)
    kept_.emplace(LinearModel(*campaign_, result_).with_smoothing(smoothing_), setting_, noise_estimate_);
  return *kept_;
}

std::shared_ptr<const Projector> Session::Fitted::projector_of_all_readings() const {
  const ModelState own = state();
  const UndisturbedLock lock(mutex_);
  if (!all_readings_) all_readings_ = own.projector_of_all_readings();
  return all_readings_;
}

void Session::Fitted::let_go() const {
  const std::lock_guard lock(mutex_);
  kept_.reset();
  all_readings_.reset();
}

bool Session::Fitted::is_kept() const {
  const std::lock_guard lock(mutex_);
  return kept_.has_value();
}

EffectFinding Session::Fitted::fitted(const EffectFinding& added) const {
  EffectFinding out = added;  // with p, gain and visible share of when it was added
  out.amplitudes.clear();
  out.shape_text.clear();
  const auto projector = projector_of_all_readings();
  const DatumSpace datum(result_.layout, campaign_->machine, result_.parameters);
  for (const EffectSpec& spec : result_.identified.effects) {
    const auto effect = find_effect(spec.kind)->make(spec, {});
    if (effect->name() != added.name) continue;
    out.spec = spec;
    for (const EffectAmplitude& amplitude : effect->amplitudes()) {
      const ParameterBlock* block = result_.layout.find_block(amplitude.label);
      if (block == nullptr) continue;  // one of the coefficients of a surface
      Eigen::MatrixXd row = Eigen::MatrixXd::Zero(1, result_.parameters.size());
      row(0, block->offset) = 1.0;
      const double value = values_[block->offset];
      const double u = std::sqrt(projector->prediction_variance(datum.reduce_rows(row))[0]);
      out.amplitudes.push_back({amplitude.label, value, u, std::numeric_limits<double>::quiet_NaN(),
                                amplitude.unit(), amplitude.si_per_unit()});
      amplitude.keep(value, out.spec.options);
    }
  }
  return out;
}

ModelState Session::Recipe::without_effects() const {
  if (refit) {
    const ModelState state = with_residuals_of_fit();
    return refit->residual.size() > 0 ? state.with_residual(refit->residual) : state;
  }
  const ModelState state = base->state();
  return state.shared_setting() == setting ? state : state.with_setting(setting);
}

ModelState Session::Recipe::with_residuals_of_fit() const {
  LinearModel model = base->state().model();
  if (!refit->smoothing.empty()) model = model.with_smoothing(refit->smoothing);
  if (!refit->reinstated.empty()) model = model.with_reinstated(refit->reinstated);
  return {std::move(model), setting, refit->noise};
}

ModelState Session::Recipe::with_effects(ModelState state) const {
  for (const FamilyTest& test : added) state = state.with_at_this_noise(test);
  return state;
}

ModelState Session::Recipe::make() const { return with_effects(without_effects()); }

std::shared_ptr<const Projector> Session::Recipe::projector_without_effects() const {
  if (!refit) return base->projector_of_all_readings();
  std::shared_ptr<const Projector> projector = with_residuals_of_fit().projector_of_all_readings();
  if (refit->residual.size() == 0) return projector;
  return std::make_shared<const Projector>(projector->with_residual(refit->residual));
}

/// A refit of the fit itself has other residuals, and the columns of the fit's own projector.
std::shared_ptr<const Projector> Session::Recipe::projector_at(const Fitted& least,
                                                               const ModelState& state) const {
  if (base.get() != &least || !reinstated().empty())
    return state.projector_at(least.noise(), base->smoothing());
  auto projector =
      std::make_shared<Projector>(base->state().projector().with_residual(state.model().problem().residual));
  for (const AddedEffect& effect : state.added()) projector->accept(effect.columns);
  return projector;
}

bool Session::FiguresOfModel::is_of(const Recipe& recipe,
                                    const std::shared_ptr<const Fitted>& against) const {
  return base == recipe.base && least == against && reinstated == recipe.reinstated();
}

/// Residuals count for nothing in them, nor does the noise of a refit: of one that uses the same readings
/// they are those of the fit.
std::shared_ptr<const Session::FiguresOfModel> Session::FiguresOfModel::of(
    const Recipe& recipe, const std::shared_ptr<const Fitted>& against) {
  const bool other_readings = !recipe.reinstated().empty();
  const ModelState state = other_readings ? recipe.without_effects() : recipe.base->state();
  const auto figures = [&](const Projector& projector) {
    return std::make_shared<const FiguresOfModel>(FiguresOfModel{
        recipe.base, against, recipe.reinstated(), KeptFigures(state, against->noise(), projector)});
  };
  if (!other_readings && recipe.base == against) return figures(state.projector());
  return figures(*state.projector_at(against->noise(), recipe.base->smoothing()));
}

const CatalogueTests& Session::SharedTests::get() {
  const Interruption::Share undisturbed{nullptr};
  return get_unless_stopped();
}

const CatalogueTests& Session::SharedTests::get_unless_stopped() {
  const std::lock_guard lock(mutex_);
  if (!made_) {
    made_.emplace(make_());
    make_ = {};
  }
  return *made_;
}

const Session::RefittedModel& Session::SharedRefit::get(const SessionProgress& progress) {
  const std::lock_guard lock(mutex_);
  if (made_) return *made_;
  RefittedModel model = refitted(preview_, state_, progress);
  double change = log_change(preview_.variance(), model.recipe.variance());
  for (int step = 1; step < kRefitSteps && std::abs(change) > kMovedNoise; ++step) {
    const std::vector<double> before = model.recipe.variance();
    model = refitted(model.recipe, model.state, progress);
    change = log_change(before, model.recipe.variance());
  }
  model.at_least = model.recipe.projector_at(*least_, model.state);
  model.least = least_;
  model.tests = std::make_shared<SharedTests>([own = model.recipe] { return CatalogueTests(own.make()); });
  made_ = std::move(model);  // once it is whole: who makes it may be stopped
  return *made_;
}

Session::Node::Node(std::shared_ptr<const Fitted> fitted, std::vector<EffectFinding> added)
    : effects(std::move(added)) {
  const auto setting = fitted->setting();
  becomes({std::move(fitted), setting, {}});
}

void Session::Node::becomes(Recipe other) {
  recipe = std::move(other);
  tests = std::make_shared<SharedTests>([own = recipe] { return CatalogueTests(own.make()); });
  ranking.reset();
  why_not_visible.clear();
  unknown.reset();
  drawn.clear();
  residual.reset();
  let_go();
}

void Session::Node::becomes(RefittedModel refitted) {
  becomes(std::move(refitted.recipe));
  tests = std::move(refitted.tests);
  state_ = std::move(refitted.state);
  at_least = std::move(refitted.at_least);
  least = std::move(refitted.least);
  all_readings = std::move(refitted.all_readings);
}

const ModelState& Session::Node::state() const {
  if (!state_) state_ = recipe.make();
  return *state_;
}

void Session::Node::with_setting(std::shared_ptr<const SearchSetting> setting) {
  ModelState next = state().with_setting(setting);
  tests = std::make_shared<SharedTests>(tests->get().with_more(next));  // may throw: nothing is changed then
  state_ = std::move(next);
  recipe.setting = std::move(setting);
  ranking.reset();
  why_not_visible.clear();
  forget_prepared();
  refit_.reset();
}

Session::Node Session::Node::with(const FamilyTest& test, EffectFinding finding) const {
  Node next(recipe.base, effects);
  next.effects.push_back(std::move(finding));
  next.recipe = recipe;
  next.recipe.added.push_back(test);
  next.state_ = state().with_at_this_noise(test);
  const Eigen::MatrixXd& columns = next.state_->added().back().columns;
  const auto accepting = [&](const std::shared_ptr<const Projector>& projector) {
    auto more = std::make_shared<Projector>(*projector);
    more->accept(columns);
    return more;
  };
  next.all_readings = accepting(of_all_readings());
  if (at_least) {
    next.at_least = accepting(at_least);
    next.least = least;
  }
  next.tests = std::make_shared<SharedTests>([before = recipe, of_before = tests, after = next.recipe] {
    return of_before->get().of_next(before.make(), after.make());
  });
  return next;
}

void Session::Node::forget_prepared() {
  prepared.clear();
  is_prepared = false;
}

const std::shared_ptr<Session::SharedRefit>& Session::Node::shared_refit(
    const std::shared_ptr<const Fitted>& least_noise) const {
  if (!refit_) refit_ = std::make_shared<SharedRefit>(recipe, state(), least_noise);
  return refit_;
}

std::shared_ptr<const Projector> Session::Node::of_all_readings() const {
  if (all_readings) return all_readings;
  auto projector = recipe.projector_without_effects();
  if (recipe.added.empty()) return projector;
  auto more = std::make_shared<Projector>(*projector);
  for (const AddedEffect& added : state().added()) more->accept(added.columns);
  all_readings = std::move(more);
  return all_readings;
}

void Session::Node::let_go() {
  state_.reset();
  scanned.reset();
  previewed.clear();
  forget_prepared();
  refit_.reset();
  at_least.reset();
  least.reset();
  all_readings.reset();
}

/// Of the models before that have the same readings. Those that stand on one fit share its projector.
std::vector<std::optional<LadderStep>> Session::Fitting::figures_at(const Fitted& least) const {
  const std::vector<NoiseParameters>& noise = least.noise();
  std::map<std::pair<const Fitted*, const Refit*>, std::shared_ptr<const Projector>> of_fits;
  std::vector<std::optional<LadderStep>> figures(before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Recipe& recipe = before[i];
    if (recipe.base->campaign() != least.campaign()) continue;
    const bool was_kept = recipe.base->is_kept();
    const ModelState state = recipe.make();
    std::shared_ptr<const Projector>& of_fit = of_fits[{recipe.base.get(), recipe.refit.get()}];
    if (!of_fit) of_fit = recipe.without_effects().projector_at(noise);
    Projector projector = *of_fit;
    for (const AddedEffect& added : state.added()) projector.accept(added.columns);
    figures[i] = last_step_at(state, noise, projector);
    if (!was_kept) recipe.base->let_go();
  }
  return figures;
}

Session::FittedModel Session::Fitting::operator()(const std::shared_ptr<const Campaign>& campaign,
                                                  const ModelSpec& model,
                                                  const SessionProgress& progress) const {
  FitResult result = fit(*campaign, model, fit_options(options.threads, progress));
  report_stage(progress, "noise", kShareOfFit);
  const LinearModel linear(*campaign, result);
  auto setting = std::make_shared<const SearchSetting>(linear, heldout_lines(linear, options.heldout_share),
                                                       std::vector<std::string>{}, options.threads, own);
  auto fitted =
      std::make_shared<const Fitted>(campaign, std::move(result), ModelState(linear, std::move(setting)));
  report_stage(progress, "models against this noise", kShareOfNoise);
  std::vector<std::optional<LadderStep>> figures;
  if (fitted->noise_variance() < least_variance) figures = figures_at(*fitted);
  report_stage(progress, "done", 1.0);
  return {std::move(fitted), std::move(figures)};
}

}  // namespace volcal
