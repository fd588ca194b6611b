#include "volcal/identify/criticism/ladder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace volcal {
namespace {

constexpr std::int32_t kStretch = 10;

/// Variance of an observation on its own, all parts of the noise.
std::vector<double> noise_variance(const NoiseProblem& problem, std::span<const NoiseParameters> noise) {
  std::vector<double> variance(problem.data.sigma.size(), 0.0);
  for (const NoiseSequence& sequence : problem.data.sequences) {
    const NoiseParameters& part = noise[sequence.group];
    for (const std::size_t i : sequence.observation) {
      const double white = part.white * problem.data.sigma[i];
      const double long_part = part.per_metre * problem.data.length[i];
      variance[i] = white * white + part.wander * part.wander + part.line * part.line + long_part * long_part;
    }
  }
  return variance;
}

}  // namespace

std::vector<bool> heldout_lines(const LinearModel& model, double share) {
  std::vector<bool> heldout(model.size(), false);
  if (!(share > 0.0)) return heldout;
  const auto every = std::max(2, static_cast<int>(std::lround(1.0 / share)));
  const auto& setups = model.campaign().setups;
  std::vector<std::map<std::int32_t, int>> order(setups.size());
  for (std::size_t setup = 0; setup < setups.size(); ++setup) {
    for (const std::int32_t line : setups[setup].readings.line) {
      order[setup].try_emplace(line, static_cast<int>(order[setup].size()));
    }
  }
  for (std::size_t i = 0; i < model.size(); ++i) {
    const auto& [setup, row, channel] = model.observations()[i];
    const Readings& readings = setups[setup].readings;
    const bool by_line = static_cast<int>(order[setup].size()) >= every;
    const int group = by_line ? order[setup].at(readings.line[row]) : static_cast<int>(row) / kStretch;
    heldout[i] = (group + static_cast<int>(setup)) % every == every - 1;
  }
  return heldout;
}

LadderStep ladder_step(const LinearModel& model, const std::vector<bool>& heldout,
                       std::span<const NoiseParameters> noise, const Projector& projector,
                       const std::vector<Eigen::MatrixXd>& accepted, std::optional<double>& loglik) {
  const NoiseProblem& problem = model.problem();
  const Eigen::VectorXd solution = projector.solution();
  Eigen::VectorXd residual = problem.residual - problem.jacobian * solution.head(problem.jacobian.cols());
  Eigen::Index at = problem.jacobian.cols();
  for (const Eigen::MatrixXd& columns : accepted) {
    residual -= columns * solution.segment(at, columns.cols());
    at += columns.cols();
  }
  const std::vector<double> variance = noise_variance(problem, noise);
  double fit = 0.0, held = 0.0, floor = 0.0, squares_of_variance = 0.0, loglik_now = 0.0;
  std::size_t fit_count = 0, held_count = 0;
  for (std::size_t i = 0; i < model.size(); ++i) {
    const double square = std::pow(residual[static_cast<Eigen::Index>(i)], 2);
    if (!std::isfinite(variance[i])) continue;
    if (!heldout[i]) {
      fit += square;
      ++fit_count;
      continue;
    }
    held += square;
    floor += variance[i];
    squares_of_variance += variance[i] * variance[i];
    loglik_now -= 0.5 * (square / variance[i] + std::log(2.0 * std::numbers::pi * variance[i]));
    ++held_count;
  }
  LadderStep step;
  step.rms_fit = std::sqrt(fit / static_cast<double>(std::max<std::size_t>(fit_count, 1)));
  const double dof =
      static_cast<double>(projector.observations()) - static_cast<double>(projector.parameters());
  step.reduced_chi2 = projector.residual_squares() / std::max(1.0, dof);
  if (held_count == 0) {
    step.rms_heldout = step.noise_floor = step.systematic = std::numeric_limits<double>::quiet_NaN();
    return step;
  }
  const auto count = static_cast<double>(held_count);
  const double excess = (held - floor) / count;
  const double spread = 1.96 * std::sqrt(2.0 * squares_of_variance) / count;
  step.rms_heldout = std::sqrt(held / count);
  step.noise_floor = std::sqrt(floor / count);
  step.systematic = std::sqrt(std::max(0.0, excess));
  step.systematic_low = std::sqrt(std::max(0.0, excess - spread));
  step.systematic_high = std::sqrt(std::max(0.0, excess + spread));
  step.heldout_loglik_gain = loglik ? loglik_now - *loglik : 0.0;
  loglik = loglik_now;
  return step;
}

}  // namespace volcal
