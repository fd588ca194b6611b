#pragma once
/// Estimates of drawn campaigns by chord steps: equation (1) of repeated_campaign.h solved by
///
///   z <- z - t H (J(z)^T Sigma^-1 (f(z) - y) + P (z - s)),
///
/// the gradient exact at every point. H is the inverse curvature at the identified machine, of parameters
/// that the readings hardly determine and feel in the second order that of the draw (weak_parameters.h), with
/// what the gradients of a draw's earlier steps tell of the curvature where it stands (BFGS, two-loop
/// recursion: Nocedal and Wright 2006, Numerical Optimization, algorithm 7.4; a chord step where there are
/// none). t is 1, or shorter where the gradient along the step does not fall (curvature condition of Wolfe,
/// ibid. 3.7). The start is (2), a matrix product over many draws, or the solution of the second order.
/// Lengths of steps are in standard deviations, |step|^2 = step^T H^-1 step; a draw ends when the steps to
/// come, by the contraction of the last, amount to less than kEnough. Draws step side by side where the model
/// allows it; a draw's steps are the same to rounding whatever draws stand beside it, and to the bit beside
/// the same draws, which a study's batches are by their numbers. What the model holds fixed in
/// an adjustment (the transforms' second-order remainder, the expansion of effects about their shape) stays
/// that of the identified machine.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <optional>
#include <vector>

#include "volcal/identify/montecarlo/campaign_gradient.h"
#include "volcal/identify/montecarlo/draw_gradients.h"
#include "volcal/identify/montecarlo/repeated_campaign.h"
#include "volcal/identify/montecarlo/weak_parameters.h"

namespace volcal {

class ChordSolver {
 public:
  static constexpr double kEnough = 1e-4;  ///< standard deviations: 30 pm where u is 0.3 um
  static constexpr int kMostGradients = 60;

  /// `campaign` must outlive the object.
  explicit ChordSolver(const RepeatedCampaign& campaign);

  /// Memory of one thread.
  struct Workspace {
    explicit Workspace(const ChordSolver& solver);

    CampaignGradient::Workspace one;
    std::optional<DrawGradients::Workspace> several;
  };

  struct Outcome {
    int gradients = 0;     ///< taken
    double to_come = 0.0;  ///< bound on what further steps would change, standard deviations
    bool converged = false;
  };
  /// `deviations`: z - z^, without roughness, a column per draw; from the linear estimates to the solutions.
  std::vector<Outcome> solve(const std::vector<CampaignDraw>& draws, Eigen::Ref<Eigen::MatrixXd> deviations,
                             Workspace& work) const;

 private:
  class Path;

  /// Gradients of draws, each at its point.
  Eigen::MatrixXd gradients(const std::vector<const CampaignDraw*>& draws, const Eigen::MatrixXd& deviations,
                            Workspace& work) const;
  void advance(const std::vector<Path*>& paths, const Eigen::MatrixXd& gradients) const;
  Eigen::VectorXd gradient_at(const CampaignDraw& draw, const Eigen::VectorXd& deviation,
                              Workspace& work) const;
  Eigen::MatrixXd together(const CampaignDraw* const* draws, const Eigen::MatrixXd& deviations,
                           Workspace& work) const;

  const RepeatedCampaign& campaign_;
  Eigen::SparseMatrix<double> prior_;  ///< P
  CampaignGradient gradient_;
  std::optional<DrawGradients> together_;
  WeakParameters weak_;
};

}  // namespace volcal
