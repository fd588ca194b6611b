#pragma once
/// Estimates of batches of drawn campaigns by the nonlinear paths, on any thread.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "volcal/identify/montecarlo/campaign_refit.h"
#include "volcal/identify/montecarlo/chord_solver.h"
#include "volcal/identify/montecarlo/idle_pool.h"
#include "volcal/identify/montecarlo/repeated_campaign.h"

namespace volcal {

/// What solving took, over draws.
struct SolverTally {
  std::uint64_t steps = 0;          ///< gradients, or iterations of refits
  std::uint64_t refitted = 0;       ///< draws that chord steps did not solve
  std::uint64_t not_converged = 0;  ///< refits
  double to_come = 0.0;             ///< largest of ChordSolver::Outcome

  void add(const SolverTally& other);
};

class PathSolvers {
 public:
  /// `campaign` must outlive the object.
  explicit PathSolvers(const RepeatedCampaign& campaign) : repeated_(campaign), chord_(campaign) {}

  /// Deviations z - z^, parameters x draws, without roughness.
  /// Draws that steps do not solve are refitted.
  Eigen::MatrixXd by_chord(const std::vector<CampaignDraw>& draws, SolverTally& tally);
  Eigen::MatrixXd by_refit(const std::vector<CampaignDraw>& draws, SolverTally& tally);

 private:
  const RepeatedCampaign& repeated_;
  ChordSolver chord_;
  IdlePool<ChordSolver::Workspace> workspaces_;
  IdlePool<CampaignRefit> refits_;
};

}  // namespace volcal
