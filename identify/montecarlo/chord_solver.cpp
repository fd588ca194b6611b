#include "volcal/identify/montecarlo/chord_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace volcal {
namespace {

constexpr double kFallsAlongAStep = 0.9;  // of the gradient along a step: Wolfe's c2
constexpr double kShortest = 0.02;        // of a step, in one go

/// Share of a step at which the gradient along it would vanish if it were linear in between.
double shortened(double before, double after) { return std::max(kShortest, before / (before - after)); }

}  // namespace

ChordSolver::ChordSolver(const RepeatedCampaign& campaign)
    : campaign_(campaign), gradient_(campaign.linear_model().model(), campaign.whitener()) {
  if (StateMap::is_exact_for(campaign.linear_model().model()))
    together_.emplace(gradient_.model(), campaign.whitener());
}

ChordSolver::Workspace::Workspace(const ChordSolver& solver) : one(solver.gradient_) {
  if (solver.together_) several.emplace(*solver.together_);
}

Eigen::VectorXd ChordSolver::gradient_at(const CampaignDraw& draw, const Eigen::VectorXd& readings,
                                         const Eigen::VectorXd& deviation, Workspace& work) const {
  const Eigen::VectorXd raw = campaign_.datum().raw(campaign_.identified() + deviation);
  return campaign_.datum().reduce_gradient(gradient_.at(raw, readings, work.one)) +
         campaign_.prior_precision() * (deviation - draw.statement);
}

Eigen::MatrixXd ChordSolver::first_gradients(const std::vector<CampaignDraw>& draws,
                                             const Eigen::MatrixXd& deviations, Workspace& work) const {
  constexpr Eigen::Index kAtOnce = DrawGradients::kDraws;
  const auto count = static_cast<Eigen::Index>(draws.size());
  Eigen::MatrixXd gradients(deviations.rows(), count);
  for (Eigen::Index first = 0; together_ && first < count; first += kAtOnce) {
    const Eigen::Index several = std::min(kAtOnce, count - first);
    gradients.middleCols(first, several) =
        together(draws.data() + first, deviations.middleCols(first, several), work);
  }
  for (Eigen::Index k = 0; !together_ && k < count; ++k) {
    const CampaignDraw& draw = draws[static_cast<std::size_t>(k)];
    gradients.col(k) = gradient_at(draw, campaign_.predicted() + draw.errors, deviations.col(k), work);
  }
  return gradients;
}

/// Of as many draws as there are deviations.
Eigen::MatrixXd ChordSolver::together(const CampaignDraw* draws, const Eigen::MatrixXd& deviations,
                                      Workspace& work) const {
  const Eigen::Index count = deviations.cols();
  Eigen::MatrixXd raw(campaign_.linear_model().model().layout().size, count);
  Eigen::MatrixXd readings(campaign_.observations(), count), beside(campaign_.parameters(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    raw.col(k) = campaign_.datum().raw(campaign_.identified() + deviations.col(k));
    readings.col(k) = campaign_.predicted() + draws[k].errors;
    beside.col(k) = deviations.col(k) - draws[k].statement;
  }
  const Eigen::MatrixXd of_readings = together_->at(raw, readings, *work.several);
  Eigen::MatrixXd gradients = campaign_.prior_precision() * beside;
  for (Eigen::Index k = 0; k < count; ++k)
    gradients.col(k) += campaign_.datum().reduce_gradient(of_readings.col(k));
  return gradients;
}

Eigen::VectorXd ChordSolver::step_from(const Eigen::VectorXd& gradient,
                                       const std::vector<Curvature>& known) const {
  Eigen::VectorXd q = gradient;
  std::vector<double> share(known.size());
  for (std::size_t i = known.size(); i-- > 0;) {
    share[i] = known[i].step.dot(q) / known[i].product;
    q -= share[i] * known[i].change;
  }
  Eigen::VectorXd step = campaign_.gain() * q;
  for (std::size_t i = 0; i < known.size(); ++i)
    step += (share[i] - known[i].change.dot(step) / known[i].product) * known[i].step;
  return -step;
}

ChordSolver::Outcome ChordSolver::solve(const CampaignDraw& draw, Eigen::VectorXd gradient,
                                        Eigen::Ref<Eigen::VectorXd> deviation, Workspace& work) const {
  const Eigen::VectorXd readings = campaign_.predicted() + draw.errors;
  std::vector<Curvature> known;
  // The linear step has about one standard deviation per parameter.
  double before = std::sqrt(static_cast<double>(deviation.size()));
  Outcome outcome;
  Point at{deviation, std::move(gradient)};
  for (outcome.gradients = 1;; ++outcome.gradients) {
    Eigen::VectorXd step = step_from(at.gradient, known);
    const double along = at.gradient.dot(step);
    const double length = std::sqrt(std::max(0.0, -along)), contraction = length / before;
    outcome.to_come = contraction < 1.0 ? length * contraction / (1.0 - contraction)
                                        : std::numeric_limits<double>::infinity();
    outcome.converged = outcome.to_come < kEnough;
    deviation = at.deviation + step;
    if (outcome.converged || outcome.gradients >= kMostGradients || !std::isfinite(length)) return outcome;
    Point next{deviation, gradient_at(draw, readings, deviation, work)};
    for (double after = next.gradient.dot(step); after > -kFallsAlongAStep * along;
         after = next.gradient.dot(step)) {
      step *= shortened(along, after);
      next = {at.deviation + step, Eigen::VectorXd()};
      next.gradient = gradient_at(draw, readings, next.deviation, work);
      if (++outcome.gradients >= kMostGradients) break;
    }
    Eigen::VectorXd change = next.gradient - at.gradient;
    const double product = step.dot(change);
    if (product > 0.0) known.push_back({step, std::move(change), product});
    at = std::move(next);
    before = length;
  }
}

}  // namespace volcal
