#pragma once
/// Parameters that the readings hardly determine and that act on them in the second order, as the centre of a
/// ball-bar across its plane: with d the deviation z - z^ and D_a the second derivative of the readings to
/// parameter a,
///
///   f(z) = f(z^) + J d + 1/2 sum_a d_a^2 D_a
///
/// It leaves out mixed derivatives, as of the centre and the machine's displacement across the plane: about a
/// tenth of what the squares do.
/// A draw of (1) in repeated_campaign.h then is a linear system but for a few unknowns, d_a and c_a^T d with
/// c_a = J^T Sigma^-1 D_a, which Newton steps find without any reading; and the curvature of the cost at the
/// solution is that at z^ plus a matrix of twice their number in rank (Woodbury). Both are a start and a
/// scale for steps with the exact gradient (chord_solver.h), which end the same without them, only later.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/montecarlo/repeated_campaign.h"

namespace volcal {

class WeakParameters {
 public:
  /// `campaign` must outlive the object.
  explicit WeakParameters(const RepeatedCampaign& campaign);

  Eigen::Index size() const { return static_cast<Eigen::Index>(which_.size()); }
  /// Reduced coordinates, ascending.
  const std::vector<Eigen::Index>& which() const { return which_; }

  /// Of the second-order model of one draw.
  struct Solution {
    Eigen::VectorXd deviation;
    Eigen::MatrixXd correction;  ///< of the inverse curvature, on the rows of inverse_times_weak()
  };
  /// `linear`: the draw's linear estimate.
  Solution solve(const CampaignDraw& draw, const Eigen::VectorXd& linear) const;
  /// H gradient, H the inverse curvature about a solution; that at z^ where it holds none.
  Eigen::VectorXd inverse_curvature(const Solution& solution, const Eigen::VectorXd& gradient) const;

 private:
  struct Unknowns;
  Unknowns error_of(const Unknowns& at, const Unknowns& start, const Eigen::VectorXd& of_errors) const;
  Eigen::MatrixXd slope_at(const Unknowns& at, const Eigen::VectorXd& of_errors) const;
  Eigen::MatrixXd curvature_at(const Unknowns& at, const Eigen::VectorXd& of_errors) const;

  const RepeatedCampaign& campaign_;
  std::vector<Eigen::Index> which_;
  Eigen::MatrixXd weighed_;      ///< Sigma^-1 D, observations x weak
  Eigen::MatrixXd coupling_;     ///< c, parameters x weak
  Eigen::MatrixXd strength_;     ///< D^T Sigma^-1 D
  Eigen::MatrixXd of_unknowns_;  ///< C [e c], parameters x 2 weak
  Eigen::MatrixXd among_;        ///< [e c]^T C [e c]
};

}  // namespace volcal
