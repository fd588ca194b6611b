#pragma once
/// Estimates of drawn campaigns by chord steps: equation (1) of repeated_campaign.h solved by
///
///   z <- z - t H (J(z)^T Sigma^-1 (f(z) - y) + P (z - s)),
///
/// the gradient exact at every point. H is C, the inverse curvature at the identified machine, with what the
/// gradients of a draw's earlier steps tell of the curvature where it stands (BFGS, two-loop recursion:
/// Nocedal and Wright 2006, Numerical Optimization, algorithm 7.4; a chord step where there are none), which
/// parameters need that the readings hardly determine at z^, as the centre of a ball-bar across its plane. t
/// is 1, or shorter where the gradient along the step does not fall (curvature condition of Wolfe,
/// ibid. 3.7). The first step is (2), a matrix product over many draws. Lengths of steps are in standard
/// deviations, |step|^2 = step^T H^-1 step; a draw ends when the steps to come, by the contraction of the
/// last, amount to less than kEnough. What the model holds fixed in an adjustment (the transforms'
/// second-order remainder, the expansion of effects about their shape) stays that of the identified machine.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "volcal/identify/montecarlo/campaign_gradient.h"
#include "volcal/identify/montecarlo/draw_gradients.h"
#include "volcal/identify/montecarlo/repeated_campaign.h"

namespace volcal {

class ChordSolver {
 public:
  static constexpr double kEnough = 1e-5;  ///< standard deviations: 3 pm where u is 0.3 um
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
  /// Gradients at the linear estimates of draws (deviations z - z^, without roughness), a column per draw:
  /// side by side where the model allows it, one after another where it does not.
  Eigen::MatrixXd first_gradients(const std::vector<CampaignDraw>& draws, const Eigen::MatrixXd& deviations,
                                  Workspace& work) const;
  /// From the linear estimate of a draw and the gradient there to the solution.
  Outcome solve(const CampaignDraw& draw, Eigen::VectorXd gradient, Eigen::Ref<Eigen::VectorXd> deviation,
                Workspace& work) const;

 private:
  /// Of one draw.
  struct Point {
    Eigen::VectorXd deviation;
    Eigen::VectorXd gradient;
  };
  /// A step and how the gradient changed along it.
  struct Curvature {
    Eigen::VectorXd step;
    Eigen::VectorXd change;
    double product = 0.0;
  };

  Eigen::VectorXd gradient_at(const CampaignDraw& draw, const Eigen::VectorXd& readings,
                              const Eigen::VectorXd& deviation, Workspace& work) const;
  Eigen::MatrixXd together(const CampaignDraw* draws, const Eigen::MatrixXd& deviations,
                           Workspace& work) const;
  Eigen::VectorXd step_from(const Eigen::VectorXd& gradient, const std::vector<Curvature>& known) const;

  const RepeatedCampaign& campaign_;
  CampaignGradient gradient_;
  std::optional<DrawGradients> together_;
};

}  // namespace volcal
