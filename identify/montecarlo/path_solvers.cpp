#include "volcal/identify/montecarlo/path_solvers.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace volcal {

void SolverTally::add(const SolverTally& other) {
  steps += other.steps;
  refitted += other.refitted;
  not_converged += other.not_converged;
  to_come = std::max(to_come, other.to_come);
}

Eigen::MatrixXd PathSolvers::by_chord(const std::vector<CampaignDraw>& draws, SolverTally& tally) {
  Eigen::MatrixXd deviations = repeated_.linear_estimates(draws);
  auto work = workspaces_.take([this] { return std::make_unique<ChordSolver::Workspace>(chord_); });
  const std::vector<ChordSolver::Outcome> outcomes = chord_.solve(draws, deviations, *work);
  std::vector<std::size_t> left;
  for (std::size_t k = 0; k < draws.size(); ++k) {
    const ChordSolver::Outcome& outcome = outcomes[k];
    tally.steps += static_cast<std::uint64_t>(outcome.gradients);
    if (outcome.converged) {
      tally.to_come = std::max(tally.to_come, outcome.to_come);
    } else {
      left.push_back(k);
    }
  }
  workspaces_.give_back(std::move(work));
  tally.refitted += left.size();
  for (const std::size_t k : left) deviations.col(static_cast<Eigen::Index>(k)) = by_refit({draws[k]}, tally);
  return deviations;
}

Eigen::MatrixXd PathSolvers::by_refit(const std::vector<CampaignDraw>& draws, SolverTally& tally) {
  Eigen::MatrixXd deviations(repeated_.parameters(), static_cast<Eigen::Index>(draws.size()));
  auto refit = refits_.take([this] { return std::make_unique<CampaignRefit>(repeated_); });
  for (std::size_t k = 0; k < draws.size(); ++k) {
    const CampaignRefit::Outcome outcome = refit->solve(draws[k]);
    deviations.col(static_cast<Eigen::Index>(k)) = outcome.deviation;
    tally.steps += static_cast<std::uint64_t>(outcome.iterations);
    if (!outcome.converged) ++tally.not_converged;
  }
  refits_.give_back(std::move(refit));
  return deviations;
}

}  // namespace volcal
