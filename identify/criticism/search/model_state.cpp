#include "volcal/identify/criticism/search/model_state.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "volcal/identify/criticism/catalogue/shape_refinement.h"
#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/search/surface_search.h"
#include "volcal/identify/solve/correlated_adjustment.h"

namespace volcal {
namespace {

constexpr int kShapeSteps = 20;
constexpr double kSettledShape = 0.05;  // of its standard uncertainty

}  // namespace

void append_columns(const Eigen::MatrixXd& more, Eigen::MatrixXd& all) {
  const Eigen::Index before = all.cols();
  all.conservativeResize(more.rows(), before + more.cols());
  all.rightCols(more.cols()) = more;
}

namespace {

/// Columns of amplitudes that the test of a visible effect does not see are rounding.
void clear_unseen(const ScoreTest& score, Eigen::MatrixXd& columns) {
  if (score.dof == 0) return;
  for (Eigen::Index k = 0; k < std::min(columns.cols(), score.covariance.cols()); ++k) {
    if (score.covariance(k, k) == 0.0) columns.col(k).setZero();
  }
}

}  // namespace

Eigen::MatrixXd accept(const LinearModel& model, const Family& family, const FamilyTest& effect,
                       Projector& projector) {
  Eigen::MatrixXd columns = family_columns(model, family, effect.shape);
  if (!family.orders.empty())
    columns.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(effect.shape[0]));
  clear_unseen(effect.score, columns);
  projector.accept(columns);
  const auto derivative = shape_derivative(model, family, effect.shape, effect.score.amplitude);
  if (!derivative) return columns;
  const ProjectedColumns projected = projector.project(*derivative);
  if (projected.gram(0, 1)(0, 0) > std::pow(kThresholds.visible_derivative * projected.norm[0], 2)) {
    projector.accept(*derivative);
    append_columns(*derivative, columns);
  }
  return columns;
}

NoiseProblem with_columns(NoiseProblem problem, const Eigen::MatrixXd& columns,
                          const Eigen::VectorXd& precision) {
  if (columns.cols() == 0) return problem;
  const Eigen::Index before = problem.jacobian.cols(), count = before + columns.cols();
  Eigen::MatrixXd all(problem.jacobian.rows(), count);
  all.leftCols(before) = problem.jacobian;
  all.rightCols(columns.cols()) = columns;
  problem.jacobian = std::move(all);
  Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(count, count);
  prior.topLeftCorner(problem.prior_mean.size(), problem.prior_mean.size()) = problem.prior_precision;
  prior.diagonal().tail(columns.cols()) = precision;
  problem.prior_precision = std::move(prior);
  const Eigen::Index known = problem.prior_mean.size();
  problem.prior_mean.conservativeResize(count);
  problem.prior_mean.tail(count - known).setZero();
  return problem;
}

ModelState::ModelState(LinearModel model, std::shared_ptr<const SearchSetting> setting)
    : setting_(std::move(setting)), model_(std::move(model)) {
  find_noise();
  steps_.push_back(step());
}

ModelState::ModelState(LinearModel model, std::shared_ptr<const SearchSetting> setting, NoiseEstimate noise)
    : setting_(std::move(setting)),
      model_(std::move(model)),
      noise_estimate_(std::move(noise)),
      noise_(noise_estimate_.parameters()),
      projector_(projector_without({})),
      steps_{step()} {}

ModelStep ModelState::step() const { return {noise_estimate_, model_.smoothing(), model_.removed().size()}; }

ModelState ModelState::with(const FamilyTest& effect) const {
  ModelState next = *this;
  next.tests_.reset();
  Projector projector = *projector_;
  next.added_.push_back({effect, accept(model_, setting_->families[effect.family], effect, projector), {}});
  next.find_noise();
  if (next.refine_shape_of_last()) next.find_noise();
  while (next.reinstate_outliers()) next.find_noise();
  next.steps_.push_back(next.step());
  return next;
}

std::optional<ModelState> ModelState::with_first(std::size_t effects) const {
  const ModelStep& then = steps_.at(effects);
  if (then.removed != model_.removed().size()) return std::nullopt;
  ModelState earlier = *this;
  earlier.tests_.reset();
  earlier.added_.resize(effects);
  earlier.steps_.resize(effects + 1);
  earlier.noise_estimate_ = then.noise;
  earlier.noise_ = then.noise.parameters();
  earlier.model_ = model_.with_smoothing(then.smoothing);
  earlier.projector_ = earlier.projector_without({});
  return earlier;
}

ModelState ModelState::with_at_this_noise(const FamilyTest& effect) const {
  ModelState next = *this;
  next.tests_.reset();
  auto projector = std::make_shared<Projector>(*projector_);
  next.added_.push_back({effect, accept(model_, setting_->families[effect.family], effect, *projector), {}});
  next.projector_ = std::move(projector);
  next.steps_.push_back(next.step());
  return next;
}

ModelState ModelState::with_residual(Eigen::VectorXd residual) const {
  if (!added_.empty()) throw std::logic_error("residuals of a model with added effects are not replaced");
  ModelState other = *this;
  other.tests_.reset();
  other.projector_ = std::make_shared<const Projector>(projector_->with_residual(residual));
  other.model_ = model_.with_residual(std::move(residual));
  return other;
}

ModelState ModelState::with_setting(std::shared_ptr<const SearchSetting> setting) const {
  ModelState other = *this;
  other.setting_ = std::move(setting);
  other.tests_.reset();
  return other;
}

ModelState ModelState::with_surface(const SurfaceTest& surface,
                                    const std::vector<AddedEffect>& beside) const {
  ModelState next = *this;
  next.tests_.reset();
  next.surfaces_.push_back({surface.spec, surface.effect, surface.finding, surface.log_evidence,
                            model_.problem().jacobian.cols(), model_.smoothing().size(), model_});
  next.model_ = model_.with_surface(*surface.effect);
  next.added_ = beside;
  next.model_ = next.model_.with_imitated_left_to_the_rest(next.projector_without({})->gram());
  next.added_.clear();
  next.find_noise();
  next.steps_ = {next.step()};
  return next;
}

bool ModelState::has_surface(const EffectName& name) const {
  return std::ranges::any_of(surfaces_,
                             [&](const AddedSurface& each) { return each.effect->name() == name; });
}

ModelState ModelState::tested() const { return is_tested() ? *this : with_tests(tests_of(*this)); }

ModelState ModelState::with_tests(ModelTests tests) const {
  ModelState other = *this;
  other.tests_ = std::make_shared<ModelTests>(std::move(tests));
  return other;
}

ModelState ModelState::with_comparisons(std::vector<AddedEffect> added) const {
  ModelState other = *this;
  other.added_ = std::move(added);
  return other;
}

const ModelTests& ModelState::tests() const {
  if (!tests_) throw std::logic_error("this state of the model was not tested");
  return *tests_;
}

/// Noise of all readings, then smoothing under it by those that are not held out, as the projector that
/// chooses; again where the smoothing changes, since either takes the other's part. Starts from what is
/// known.
void ModelState::find_noise() {
  NoiseOptions options = noise_options();
  options.uncertainty = false;
  const int rounds = model_.smoothing().empty() ? 1 : kThresholds.noise_rounds;
  for (int round = 0; round < rounds; ++round) {
    noise_estimate_ = estimate_noise(problem(), options, noise_.empty() ? nullptr : &noise_estimate_);
    noise_ = noise_estimate_.parameters();
    projector_ = projector_without({});
    if (model_.smoothing().empty()) return;
    const std::vector<SmoothingTerm> before = model_.smoothing();
    model_ = model_.smoothed(projector_->gram(), projector_->observations(), setting_->threads);
    if (alike(before, model_.smoothing())) break;
  }
  projector_ = projector_without({});
}

NoiseOptions ModelState::noise_options() const {
  NoiseOptions options;
  options.threads = setting_->threads;
  options.drift_threshold = kThresholds.drift_evidence;
  return options;
}

NoiseEstimate ModelState::readjusted_noise(const Projector& without_effects) const {
  const NoiseProblem& own = model_.problem();
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(model_.size()), 0);
  for (const AddedEffect& effect : added_) append_columns(effect.columns, columns);
  Projector with_effects = without_effects;
  with_effects.accept(columns);
  const Eigen::VectorXd solution = with_effects.solution();
  NoiseProblem left;
  Eigen::MatrixXd apart = columns;
  apart.noalias() -= own.jacobian * without_effects.imitation(columns).topRows(own.jacobian.cols());
  left.jacobian = std::move(apart);
  left.residual = own.residual - own.jacobian * solution.head(own.jacobian.cols()) -
                  columns * solution.tail(columns.cols());
  left.data = own.data;
  left.point = own.point;
  NoiseOptions options = noise_options();
  options.uncertainty = false;
  return readjust_noise(left, options, noise_estimate_);
}

std::vector<FamilyTest> ModelState::moved_effects(const Projector& all) const {
  const Eigen::VectorXd solution = all.solution();
  Eigen::Index at = solution.size() - all.accepted();
  std::vector<FamilyTest> moved;
  for (const AddedEffect& effect : added_) {
    FamilyTest& test = moved.emplace_back(effect.test);
    const Family& family = family_of(effect);
    const Eigen::Index amplitudes = std::min(family.amplitudes(), effect.columns.cols());
    test.score.amplitude.setZero(family.amplitudes());
    test.score.amplitude.head(amplitudes) = solution.segment(at, amplitudes);
    if (effect.columns.cols() > amplitudes) {
      const double wanted = test.shape[0] + solution[at + amplitudes];
      const auto [low, high] =
          std::ranges::minmax(family.scan, {}, [](const Eigen::VectorXd& shape) { return shape[0]; });
      test.shape[0] = std::clamp(wanted, low[0], high[0]);
    }
    at += effect.columns.cols();
  }
  return moved;
}

ModelState ModelState::with_settled_shapes() const {
  ModelState next = *this;
  for (int step = 0; step < kShapeSteps && next.move_shapes(); ++step) next.tests_.reset();
  return next;
}

/// False: no shape has moved by more than a small part of its uncertainty.
bool ModelState::move_shapes() {
  const auto all = projector_of_all_readings();
  const Eigen::MatrixXd covariance = all->accepted_covariance();
  const std::vector<FamilyTest> moved = moved_effects(*all);
  std::vector<std::size_t> others;
  Eigen::Index at = 0;
  for (std::size_t i = 0; i < added_.size(); ++i) {
    const Eigen::Index amplitudes = family_of(added_[i]).amplitudes();
    if (added_[i].columns.cols() > amplitudes) {
      const double u = std::sqrt(covariance(at + amplitudes, at + amplitudes));
      if (std::abs(moved[i].shape[0] - added_[i].test.shape[0]) > kSettledShape * u) others.push_back(i);
    }
    at += added_[i].columns.cols();
  }
  for (const std::size_t i : others) {
    added_[i].test.shape = moved[i].shape;
    added_[i].test.score.amplitude = moved[i].score.amplitude;
    const auto without = projector_without({i});
    added_[i].columns = accept(model_, family_of(added_[i]), added_[i].test, *without);
  }
  if (!others.empty()) find_noise();
  return !others.empty();
}

NoiseEstimate ModelState::noise_with_uncertainty() const {
  return estimate_noise(problem(), noise_options(), &noise_estimate_);
}

std::unique_ptr<Projector> ModelState::projector_of_all_readings() const {
  return make_projector(model_, model_.problem().data, noise_);
}

std::unique_ptr<Projector> ModelState::projector_without(const std::set<std::size_t>& left_out) const {
  return make_projector(model_, without(model_.problem().data, setting_->heldout), noise_, left_out);
}

std::unique_ptr<Projector> ModelState::projector_at(const std::vector<NoiseParameters>& noise) const {
  return make_projector(model_, without(model_.problem().data, setting_->heldout), noise);
}

std::unique_ptr<Projector> ModelState::projector_at(const std::vector<NoiseParameters>& noise,
                                                    const std::vector<SmoothingTerm>& smoothing) const {
  return make_projector(model_.with_smoothing(smoothing), without(model_.problem().data, setting_->heldout),
                        noise);
}

std::unique_ptr<Projector> ModelState::projector_without_surface(
    const AddedSurface& surface, const std::set<std::size_t>& left_out) const {
  const LinearModel model = model_.without_surface(surface.term);
  return make_projector(model, without(model.problem().data, setting_->heldout), noise_, left_out);
}

std::unique_ptr<Projector> ModelState::make_projector(const LinearModel& model, const NoiseData& data,
                                                      const std::vector<NoiseParameters>& noise,
                                                      const std::set<std::size_t>& left_out) const {
  auto projector =
      std::make_unique<Projector>(model.problem(), data, noise, setting_->threads, model.parts());
  accept_added(left_out, *projector);
  return projector;
}

void ModelState::accept_added(const std::set<std::size_t>& left_out, Projector& projector) const {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(model_.size()), 0);
  for (std::size_t i = 0; i < added_.size(); ++i) {
    if (!left_out.contains(i)) append_columns(added_[i].columns, columns);
  }
  if (columns.cols() > 0) projector.accept(columns);
}

Eigen::VectorXd ModelState::residual() const {
  const NoiseProblem& problem = model_.problem();
  const Eigen::VectorXd solution = projector_->solution();
  Eigen::Index at = problem.jacobian.cols();
  Eigen::VectorXd residual = problem.residual - problem.jacobian * solution.head(at);
  for (const AddedEffect& effect : added_) {
    residual -= effect.columns * solution.segment(at, effect.columns.cols());
    at += effect.columns.cols();
  }
  return residual;
}

NoiseProblem ModelState::problem(const std::set<std::size_t>& left_out) const {
  Eigen::MatrixXd columns(model_.problem().jacobian.rows(), 0);
  for (std::size_t i = 0; i < added_.size(); ++i) {
    if (!left_out.contains(i)) append_columns(added_[i].columns, columns);
  }
  return with_columns(model_.problem(), columns, Eigen::VectorXd::Zero(columns.cols()));
}

bool ModelState::has(std::size_t family) const {
  return std::ranges::any_of(added_, [&](const AddedEffect& each) { return each.test.family == family; });
}

Eigen::Index ModelState::first_column(std::size_t added) const {
  Eigen::Index first = projector_->parameters() - projector_->accepted();
  for (std::size_t i = 0; i < added; ++i) first += added_[i].columns.cols();
  return first;
}

/// At the noise that the effect leaves; its shape was found at the noise that held it. True: it has changed.
bool ModelState::refine_shape_of_last() {
  AddedEffect& last = added_.back();
  const Family& family = family_of(last);
  if (family.scan.size() < 2 || last.columns.cols() == family.amplitudes()) return false;
  const auto projector = projector_without({added_.size() - 1});
  FamilyTest again = last.test;
  const ScoreTest score =
      family_score(family, projector->project(family_columns(model_, family, again.shape)), 0,
                   family.largest_amplitudes());
  update_test(again, family, again.shape, score, *projector);
  refine_shape(model_, family, *projector, again);
  if (again.shape == last.test.shape) return false;
  last.columns = accept(model_, family, again, *projector);
  last.test = std::move(again);
  return true;
}

/// False: there is none to reinstate.
bool ModelState::reinstate_outliers() {
  if (!setting_->rules.follows(SearchRule::Reinstated)) return false;
  const std::vector<std::size_t> explained = explained_outliers();
  if (explained.empty()) return false;
  setting_->rules.tell(SearchRule::Reinstated);
  model_ = model_.with_reinstated(explained);
  return true;
}

std::vector<std::size_t> ModelState::explained_outliers() const {
  const NoiseProblem& problem = model_.problem();
  const Eigen::VectorXd solution = projector_->solution();
  const std::vector<double> sigma = total_sigma(problem.data, model_.stated_sigma(), noise_);
  Eigen::MatrixXd row(1, solution.size());
  std::vector<std::size_t> explained;
  for (const std::size_t observation : model_.removed()) {
    const auto at = static_cast<Eigen::Index>(observation);
    Eigen::Index column = problem.jacobian.cols();
    row.leftCols(column) = problem.jacobian.row(at);
    for (const AddedEffect& effect : added_) {
      row.middleCols(column, effect.columns.cols()) = effect.columns.row(at);
      column += effect.columns.cols();
    }
    const double miss = problem.residual[at] - row.row(0).dot(solution);
    const double u = std::hypot(sigma[observation], std::sqrt(projector_->prediction_variance(row)[0]));
    if (std::abs(miss) < model_.outlier_critical_value() * u) explained.push_back(observation);
  }
  return explained;
}

}  // namespace volcal
