#include "volcal/identify/criticism/proposals/measurement_planner.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"
#include "volcal/identify/statistics/chi_squared.h"

namespace volcal {
namespace {

constexpr double kRounding = 1e-9;  // of the largest column of a hypothesis
constexpr double kFaint = 1e-2;  // share of an amplitude's effect, squared, that must remain: 0.01 % in all

}  // namespace

MeasurementPlanner::MeasurementPlanner(const CriticismState& state, std::vector<PlannedHypothesis> hypotheses,
                                       std::size_t given, const HypotheticalCampaign& hypothetical)
    : state_(state),
      hypotheses_(std::move(hypotheses)),
      given_(given),
      hypothetical_(hypothetical),
      noise_(state.noise.begin(), state.noise.end()),
      parameters_(state.model.problem().jacobian.cols()) {
  use_single_threaded_blas();
  noise_.resize(hypothetical.noise_groups().size());
  for (const PlannedHypothesis& each : hypotheses_) {
    range_.push_back({columns_, state.families[each.hypothesis.family].amplitudes()});
    columns_ += range_.back().count;
  }
  add_campaign();
  now_ = project(campaign_, parameters_);
  with_.resize(measurements());
  run_parallel(measurements(), state.threads, [&](std::size_t i) { with_[i] = extended(i); });
}

void MeasurementPlanner::add_campaign() {
  const NoiseProblem& problem = state_.model.problem();
  const Whitener whitener(problem.data, state_.noise);
  const auto& parts = state_.model.parts();
  std::vector<Hypothesis> all;
  for (const PlannedHypothesis& each : hypotheses_) all.push_back(each.hypothesis);
  const CandidateColumns columns = columns_of(state_.model, state_.families, std::move(all));
  std::vector<Eigen::MatrixXd> sums(parts.size() - 1);
  run_parallel(sums.size(), state_.threads, [&](std::size_t setup) {
    const Eigen::Index count = parts[setup + 1] - parts[setup];
    Eigen::MatrixXd rows(count, parameters_ + columns_);
    rows.leftCols(parameters_) = problem.jacobian.middleRows(parts[setup], count);
    columns.fill(setup, rows.rightCols(columns_));
    sums[setup] = Eigen::MatrixXd::Zero(rows.cols(), rows.cols());
    add_gram_upper(whitener.whiten_part(static_cast<std::size_t>(parts[setup]), rows), 1.0, sums[setup]);
  });
  campaign_ = std::move(sums.front());
  for (std::size_t i = 1; i < sums.size(); ++i) campaign_ += sums[i];
  symmetrise_from_upper(campaign_);
  observations_ = static_cast<double>(whitener.observations());
}

/// A column far below the others of its hypothesis is rounding: the sine of a period that divides every
/// position.
void MeasurementPlanner::clear_small_columns(ProjectedHypotheses& where) const {
  for (const auto& [first, count] : range_) {
    const double largest = where.known_norm.segment(first, count).maxCoeff();
    for (Eigen::Index k = first; k < first + count; ++k) {
      if (where.known_norm[k] > kRounding * largest) continue;
      where.known_norm[k] = 0.0;
      where.gram.row(k).setZero();
      where.gram.col(k).setZero();
    }
  }
}

/// `gram`: of parameters, then hypotheses. The campaign's priors are added here.
ProjectedHypotheses MeasurementPlanner::project(const Eigen::MatrixXd& gram, Eigen::Index parameters) const {
  Eigen::MatrixXd information = gram.topLeftCorner(parameters, parameters);
  information.topLeftCorner(parameters_, parameters_) += state_.model.problem().prior_precision;
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  information = scale.asDiagonal() * information * scale.asDiagonal();
  auto lower = cholesky_lower(information);
  if (!lower) {
    information.diagonal().array() += 1e-12;  // what neither readings nor priors determine stays where it is
    lower = cholesky_lower(information);
    if (!lower) throw std::runtime_error("the model's columns are not independent");
  }
  Eigen::MatrixXd explained = scale.asDiagonal() * gram.topRightCorner(parameters, columns_);
  solve_lower(*lower, explained);
  ProjectedHypotheses out;
  out.gram = gram.bottomRightCorner(columns_, columns_);
  out.known_norm = out.gram.diagonal().cwiseSqrt();
  add_gram_upper(explained, -1.0, out.gram);
  symmetrise_from_upper(out.gram);
  clear_small_columns(out);
  clear_invisible(out.known_norm, out.gram);
  for (std::size_t i = 0; i < given_; ++i) out.gram = projected_off(out.gram, range_[i]);
  return out;
}

ProjectedHypotheses MeasurementPlanner::extended(std::size_t measurement) const {
  const HypotheticalRows rows = hypothetical_.rows(measurement);
  const Eigen::Index fresh = rows.nuisance.cols(), parameters = parameters_ + fresh;
  Eigen::MatrixXd added(rows.model.rows(), parameters + columns_);
  added.leftCols(parameters) << rows.model, rows.nuisance;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    const auto& [family, shape] = hypotheses_[i].hypothesis;
    added.middleCols(parameters + range_[i].first, range_[i].count) =
        hypothetical_.columns(measurement, rows, *state_.families[family].effect, shape);
  }
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(parameters + columns_, parameters + columns_);
  gram.topLeftCorner(parameters_, parameters_) = campaign_.topLeftCorner(parameters_, parameters_);
  gram.topRightCorner(parameters_, columns_) = campaign_.topRightCorner(parameters_, columns_);
  gram.bottomRightCorner(columns_, columns_) = campaign_.bottomRightCorner(columns_, columns_);
  gram.diagonal().segment(parameters_, fresh) = rows.nuisance_precision;
  add_gram_upper(Whitener(rows.data, noise_).whiten_part(0, added), 1.0, gram);
  symmetrise_from_upper(gram);
  return project(gram, parameters);
}

ProjectedHypotheses MeasurementPlanner::plain(std::size_t measurement) const {
  const auto further = static_cast<double>(hypothetical_.measurements()[measurement].readings());
  return project(campaign_ * (1.0 + further / observations_), parameters_);
}

double MeasurementPlanner::one_sided(const ProjectedHypotheses& where, std::size_t own,
                                     std::size_t rival) const {
  const ColumnRange mine = range_[given_ + own], other = range_[given_ + rival];
  Eigen::VectorXd amplitude = hypotheses_[given_ + own].amplitude;
  if (amplitude.size() == 0) {
    const double noncentrality =
        detectable_noncentrality(state_.log10_level, static_cast<double>(mine.count), state_.power);
    amplitude = least_separated_amplitude(now_.gram.block(mine.first, mine.first, mine.count, mine.count),
                                          projected_off(now_.gram, mine, other),
                                          now_.known_norm.segment(mine.first, mine.count), noncentrality);
  }
  return std::max(0.0, amplitude.dot(projected_off(where.gram, mine, other) * amplitude));
}

double MeasurementPlanner::separation(const ProjectedHypotheses& where, std::size_t first,
                                      std::size_t second) const {
  return std::min(one_sided(where, first, second), one_sided(where, second, first));
}

double MeasurementPlanner::visible_fraction(const ProjectedHypotheses& where, std::size_t hypothesis) const {
  const auto [first, count] = range_[given_ + hypothesis];
  const double known = where.known_norm.segment(first, count).squaredNorm();
  return known > 0.0 ? std::sqrt(std::max(0.0, information(where, hypothesis) / known)) : 0.0;
}

double MeasurementPlanner::information(const ProjectedHypotheses& where, std::size_t hypothesis) const {
  const auto [first, count] = range_[given_ + hypothesis];
  return where.gram.diagonal().segment(first, count).sum();
}

double MeasurementPlanner::detectable(const ProjectedHypotheses& where, std::size_t hypothesis) const {
  const auto [first, count] = range_[given_ + hypothesis];
  const Eigen::MatrixXd own = where.gram.block(first, first, count, count);
  const Eigen::VectorXd u =
      amplitude_uncertainty(own, where.known_norm.segment(first, count).cwiseAbs2() * kFaint);
  return std::sqrt(detectable_noncentrality(state_.log10_level, static_cast<double>(count), state_.power)) *
         u.minCoeff();
}

}  // namespace volcal
