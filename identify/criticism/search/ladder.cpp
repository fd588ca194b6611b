#include "volcal/identify/criticism/search/ladder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/criticism/search/heldout_errors.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/result/result.h"

namespace volcal {
namespace {

constexpr std::int32_t kStretch = 10;
constexpr double kSmallestEigenvalue = 1e-9;  // of a precision with unit diagonal

/// Parameters that elements other than zero tie together, directly or through others.
std::vector<std::vector<Eigen::Index>> tied_parameters(const Eigen::MatrixXd& precision) {
  std::vector<std::vector<Eigen::Index>> groups;
  std::vector<bool> seen(static_cast<std::size_t>(precision.cols()), false);
  for (Eigen::Index first = 0; first < precision.cols(); ++first) {
    if (seen[static_cast<std::size_t>(first)]) continue;
    seen[static_cast<std::size_t>(first)] = true;
    std::vector<Eigen::Index>& group = groups.emplace_back(1, first);
    for (std::size_t next = 0; next < group.size(); ++next) {
      for (Eigen::Index other = 0; other < precision.rows(); ++other) {
        if (seen[static_cast<std::size_t>(other)] || precision(other, group[next]) == 0.0) continue;
        seen[static_cast<std::size_t>(other)] = true;
        group.push_back(other);
      }
    }
  }
  return groups;
}

/// Of the prior: as many further observations.
double prior_rank(const Eigen::MatrixXd& precision) {
  if (precision.size() == 0) return 0.0;
  const Eigen::VectorXd scale =
      precision.diagonal().unaryExpr([](double value) { return value > 0.0 ? 1.0 / std::sqrt(value) : 0.0; });
  double rank = 0.0;
  for (const std::vector<Eigen::Index>& group : tied_parameters(precision)) {
    const Eigen::VectorXd own = scale(group);
    const Eigen::VectorXd values = eigenvalues(own.asDiagonal() * precision(group, group) * own.asDiagonal());
    rank += static_cast<double>((values.array() > kSmallestEigenvalue).count());
  }
  return rank;
}

/// Derivatives of observations to all parameters, columns of effects last.
Eigen::MatrixXd rows_of(const std::vector<Eigen::Index>& observations, const NoiseProblem& problem,
                        const Eigen::MatrixXd& effects) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(observations.size()),
                       problem.jacobian.cols() + effects.cols());
  rows.leftCols(problem.jacobian.cols()) = problem.jacobian(observations, Eigen::all);
  rows.rightCols(effects.cols()) = effects(observations, Eigen::all);
  return rows;
}

HeldoutErrors errors_of_heldout(const NoiseProblem& problem, const std::vector<bool>& heldout,
                                std::span<const NoiseParameters> noise, const Projector& projector,
                                const Eigen::MatrixXd& effects) {
  const RowsOf rows = [&](const std::vector<Eigen::Index>& observations) {
    return rows_of(observations, problem, effects);
  };
  const Eigen::Index own = problem.jacobian.cols();
  const ColumnOf column = [&](Eigen::Index parameter) -> Eigen::VectorXd {
    if (parameter < own) return problem.jacobian.col(parameter);
    return effects.col(parameter - own);
  };
  return {problem.data, heldout, noise, projector, rows, column, projector.threads()};
}

/// Residuals of the model that `projector` holds, with columns of effects.
Eigen::VectorXd residuals_left(const NoiseProblem& problem, const Projector& projector,
                               const Eigen::MatrixXd& effects) {
  const Eigen::VectorXd solution = projector.solution();
  const Eigen::Index own = problem.jacobian.cols();
  return problem.residual - problem.jacobian * solution.head(own) - effects * solution.tail(effects.cols());
}

/// Of the readings that are not held out.
LadderStep fitted_figures(const LinearModel& model, const std::vector<bool>& heldout,
                          const std::vector<double>& variance, const Projector& projector, double prior_rank,
                          const Eigen::VectorXd& residual) {
  double squares = 0.0, fitted = 0.0;
  for (std::size_t i = 0; i < model.size(); ++i) {
    if (!std::isfinite(variance[i])) continue;
    if (heldout[i]) continue;
    squares += residual[static_cast<Eigen::Index>(i)] * residual[static_cast<Eigen::Index>(i)];
    fitted += 1.0;
  }
  LadderStep step;
  step.rms_fit = std::sqrt(squares / std::max(1.0, fitted));
  const double dof = static_cast<double>(projector.observations()) + prior_rank -
                     static_cast<double>(projector.parameters());
  step.reduced_chi2 = projector.residual_squares() / std::max(1.0, dof);
  step.rms_heldout = step.noise_floor = step.systematic = step.systematic_low = step.systematic_high =
      step.heldout_loglik_gain = std::numeric_limits<double>::quiet_NaN();
  return step;
}

/// Of what is above the noise; NaN where that is not known.
double root_above_noise(double squares) { return squares < 0.0 ? 0.0 : std::sqrt(squares); }

/// `loglik` is the held-out log-likelihood of the step before, and becomes this one's.
void set_heldout(const HeldoutFigures& figures, std::optional<double>& loglik, LadderStep& step) {
  const double excess = (figures.squares - figures.expected) / figures.count;
  const double spread = kCoverageFactor * figures.spread / figures.count;
  step.rms_heldout = std::sqrt(figures.squares / figures.count);
  step.noise_floor = std::sqrt(figures.expected / figures.count);
  step.systematic = root_above_noise(excess);
  step.systematic_low = root_above_noise(excess - spread);
  step.systematic_high = root_above_noise(excess + spread);
  step.heldout_loglik_gain = loglik ? figures.log_likelihood - *loglik : 0.0;
  loglik = figures.log_likelihood;
}

LadderStep ladder_step(const LinearModel& model, const std::vector<bool>& heldout,
                       std::span<const NoiseParameters> noise, const Projector& projector,
                       const Eigen::MatrixXd& effects, std::optional<double>& loglik) {
  const NoiseProblem& problem = model.problem();
  const HeldoutErrors errors = errors_of_heldout(problem, heldout, noise, projector, effects);
  const Eigen::VectorXd residual = residuals_left(problem, projector, effects);
  LadderStep step = fitted_figures(model, heldout, noise_variance(problem.data, noise), projector,
                                   prior_rank(problem.prior_precision), residual);
  if (!errors.blocks().empty()) set_heldout(heldout_figures(errors.blocks(), residual), loglik, step);
  return step;
}

/// The last step: surfaces were added first, then effects.
void name_step(const ModelState& state, std::vector<LadderStep>& ladder) {
  const std::size_t number = ladder.size() - 1, surfaces = state.surfaces().size();
  ladder.back().model = std::to_string(number);
  if (number == 0) return;
  ladder.back().added = number <= surfaces ? effect_label(*state.surfaces()[number - 1].effect)
                                           : state.family_of(state.added()[number - 1 - surfaces]).label();
}

}  // namespace

std::vector<double> noise_variance(const NoiseData& data, std::span<const NoiseParameters> noise) {
  std::vector<double> variance(data.sigma.size(), 0.0);
  for (const NoiseSequence& sequence : data.sequences) {
    const NoiseParameters& part = noise[sequence.group];
    for (const std::size_t i : sequence.observation) {
      const double white = part.white * data.sigma[i];
      const double long_part = data.length.empty() ? 0.0 : part.per_metre * data.length[i];
      variance[i] = white * white + part.drift * part.drift + part.line * part.line + long_part * long_part;
    }
  }
  return variance;
}

namespace {

/// Every how many lines one is held out; 0: none.
int every_line_of(double share) {
  return share > 0.0 ? std::max(2, static_cast<int>(std::lround(1.0 / share))) : 0;
}

}  // namespace

std::vector<std::vector<int>> heldout_groups(const Campaign& campaign, double share) {
  std::vector<std::vector<int>> groups;
  for (const Setup& setup : campaign.setups) {
    const Readings& readings = setup.readings;
    std::map<std::int32_t, int> order;
    for (const std::int32_t line : readings.line) order.try_emplace(line, static_cast<int>(order.size()));
    const bool by_line = static_cast<int>(order.size()) >= every_line_of(share);
    std::vector<int>& own = groups.emplace_back(readings.size());
    for (std::size_t row = 0; row < own.size(); ++row)
      own[row] = by_line ? order.at(readings.line[row]) : static_cast<int>(row) / kStretch;
  }
  return groups;
}

std::vector<std::vector<bool>> heldout_rows(const Campaign& campaign, double share) {
  const int every = every_line_of(share);
  std::vector<std::vector<bool>> heldout;
  for (const std::vector<int>& groups : heldout_groups(campaign, share)) {
    const int place = static_cast<int>(heldout.size());
    std::vector<bool>& rows = heldout.emplace_back(groups.size(), false);
    for (std::size_t row = 0; every > 0 && row < rows.size(); ++row)
      rows[row] = (groups[row] + place) % every == every - 1;
  }
  return heldout;
}

std::vector<bool> heldout_lines(const LinearModel& model, double share) {
  const auto rows = heldout_rows(model.campaign(), share);
  std::vector<bool> heldout;
  for (const auto& observation : model.observations())
    heldout.push_back(rows[observation.setup][observation.row]);
  return heldout;
}

bool heldout_error_not_reduced(std::span<const LadderStep> ladder) {
  const LadderStep& first = ladder.front();
  const LadderStep& last = ladder.back();
  return last.systematic_low > 0.0 && last.systematic > kThresholds.heldout_error_left * first.systematic;
}

std::vector<LadderStep> ladder_of(const ModelState& state) {
  const SearchSetting& setting = state.setting();
  std::vector<LadderStep> ladder;
  std::optional<double> loglik;
  Eigen::MatrixXd effects(static_cast<Eigen::Index>(state.model().size()), 0);
  for (const AddedSurface& surface : state.surfaces()) {
    const LinearModel& before = surface.before;
    const Projector projector(before.problem(), without(before.problem().data, setting.heldout),
                              state.noise(), setting.threads, before.parts());
    ladder.push_back(ladder_step(before, setting.heldout, state.noise(), projector, effects, loglik));
    name_step(state, ladder);
  }
  for (std::size_t i = 0; i <= state.added().size(); ++i) {
    const LinearModel model = state.model().with_smoothing(state.steps()[i].smoothing);
    Projector projector(model.problem(), without(model.problem().data, setting.heldout), state.noise(),
                        setting.threads, model.parts());
    for (std::size_t k = 0; k < i; ++k) projector.accept(state.added()[k].columns);
    if (i > 0) append_columns(state.added()[i - 1].columns, effects);
    LadderStep step = ladder_step(model, setting.heldout, state.noise(), projector, effects, loglik);
    ladder.push_back(std::move(step));
    name_step(state, ladder);
  }
  return ladder;
}

namespace {

Eigen::MatrixXd effects_of(const ModelState& state) {
  Eigen::MatrixXd effects(static_cast<Eigen::Index>(state.model().size()), 0);
  for (const AddedEffect& added : state.added()) append_columns(added.columns, effects);
  return effects;
}

LadderStep last_step(const ModelState& state, std::span<const NoiseParameters> noise,
                     const Projector& projector) {
  std::optional<double> no_step_before;
  return ladder_step(state.model(), state.setting().heldout, noise, projector, effects_of(state),
                     no_step_before);
}

}  // namespace

LadderStep last_step_of(const ModelState& state) {
  return last_step(state, state.noise(), state.projector());
}

LadderStep last_step_at(const ModelState& state, const std::vector<NoiseParameters>& noise) {
  return last_step(state, noise, *state.projector_at(noise));
}

LadderStep last_step_at(const ModelState& state, const std::vector<NoiseParameters>& noise,
                        const Projector& projector) {
  return last_step(state, noise, projector);
}

namespace {

/// [J effects] times `ways`.
Eigen::MatrixXd products(const NoiseProblem& problem, const Eigen::MatrixXd& effects,
                         const Eigen::MatrixXd& ways, int threads) {
  constexpr Eigen::Index kRows = 256;  // which stay near the processor for all ways
  const Eigen::Index count = effects.rows();
  Eigen::MatrixXd all(count, ways.cols());
  run_parallel(static_cast<std::size_t>((count + kRows - 1) / kRows), threads, [&](std::size_t item) {
    const Eigen::Index first = static_cast<Eigen::Index>(item) * kRows, rows = std::min(kRows, count - first);
    auto part = all.middleRows(first, rows);
    for (Eigen::Index way = 0; way < ways.cols(); ++way) {
      part.col(way).noalias() =
          problem.jacobian.middleRows(first, rows) * ways.col(way).head(problem.jacobian.cols());
      part.col(way).noalias() += effects.middleRows(first, rows) * ways.col(way).tail(effects.cols());
    }
  });
  return all;
}

}  // namespace

KeptFigures::KeptFigures(const ModelState& without_effects, std::vector<NoiseParameters> noise,
                         const Projector& projector)
    : noise_(std::move(noise)),
      variance_(noise_variance(without_effects.model().problem().data, noise_)),
      prior_rank_(prior_rank(without_effects.model().problem().prior_precision)),
      is_regular_(projector.is_regular()),
      errors_(errors_of_heldout(without_effects.model().problem(), without_effects.setting().heldout, noise_,
                                projector, effects_of(without_effects))) {}

LadderStep KeptFigures::last_step(const ModelState& state, const Projector& projector) const {
  const auto anew = [&] { return last_step_at(state, noise_, projector); };
  if (projector.is_regular() != is_regular_) return anew();
  const NoiseProblem& problem = state.model().problem();
  const std::vector<bool>& heldout = state.setting().heldout;
  HeldoutErrors::Accepted accepted;
  accepted.columns = effects_of(state);
  accepted.directions = projector.last_directions(accepted.columns.cols());
  Eigen::MatrixXd ways(projector.parameters(), accepted.columns.cols() + 1);
  ways << accepted.directions, projector.solution();
  Eigen::MatrixXd moved = products(problem, accepted.columns, ways, projector.threads());
  const Eigen::VectorXd residual = problem.residual - moved.rightCols(1);
  LadderStep step = fitted_figures(state.model(), heldout, variance_, projector, prior_rank_, residual);
  if (errors_.blocks().empty()) return step;
  accepted.moved = moved.leftCols(accepted.columns.cols());
  const auto figures = accepted.columns.cols() > 0
                           ? errors_.figures_accepting(accepted, residual, projector.threads())
                           : heldout_figures(errors_.blocks(), residual);
  if (!figures) return anew();
  std::optional<double> no_step_before;
  set_heldout(*figures, no_step_before, step);
  return step;
}

namespace {

/// With `effect`, and of the added ones all but some.
LadderStep step_with(const ModelState& state, const std::set<std::size_t>& left_out,
                     const FamilyTest& effect) {
  const SearchSetting& setting = state.setting();
  const LinearModel& model = state.model();
  Projector projector = *state.projector_without(left_out);
  Eigen::MatrixXd effects(static_cast<Eigen::Index>(model.size()), 0);
  for (std::size_t i = 0; i < state.added().size(); ++i) {
    if (!left_out.contains(i)) append_columns(state.added()[i].columns, effects);
  }
  append_columns(accept(model, setting.families[effect.family], effect, projector), effects);
  std::optional<double> no_step_before;
  return ladder_step(model, setting.heldout, state.noise(), projector, effects, no_step_before);
}

}  // namespace

LadderStep ladder_step_beside(const ModelState& state, const FamilyTest& effect) {
  return step_with(state, {}, effect);
}

LadderStep ladder_step_with(const ModelState& state, std::size_t added, const FamilyTest& instead) {
  return step_with(state, {added}, instead);
}

}  // namespace volcal
