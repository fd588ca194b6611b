#pragma once
/// Parameters that the readings hardly determine and that act on them in the second order, as the centre of a
/// ball-bar across its plane: with d the deviation z - z^ and D_a the second derivative of the readings to
/// parameter a,
///
///   f(z) = f(z^) + J d + sum_a (1/2 d_a^2 D_a + d_a E_a d)
///
/// E_a are the mixed derivatives of a and all other parameters, as of the centre and the machine's
/// displacement across the plane (half of them where both are weak, so that a pair counts once). Of E_a the
/// few patterns are kept that readings feel, U_k v_k^T: a pivoted Cholesky decomposition of the covariance
/// E_a C E_a^T of what they do (Harbrecht, Peters and Schneider 2012, Appl. Numer. Math. 62, 428-440), turned
/// to its principal axes. With x the numbers d_a / u_a and v_k^T d, and phi(x) their products 1/2 x_a^2 and
/// x_a x_k, this is J d + Q phi(F^T d). A draw of (1) in repeated_campaign.h then is a linear system but for
/// a few unknowns, x and G^T d with G = J^T Sigma^-1 Q, which Newton steps find without any reading
/// (shortened by the natural test of monotonicity: Deuflhard 2004, Newton Methods for Nonlinear
/// Problems, 3.3); and the curvature of the cost at the solution is that at z^ plus a matrix of twice their
/// number in rank (Woodbury). Both are a start and a scale for steps with the exact gradient
/// (chord_solver.h), which end the same without them, only later.

#include <Eigen/Core>
#include <Eigen/LU>
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
    Eigen::MatrixXd correction;  ///< of the inverse curvature, on C [F G]; without rows where there is none
    double bend = 0.0;           ///< from the linear estimate, standard deviations
  };
  /// `linear`: the draw's linear estimate.
  Solution solve(const CampaignDraw& draw, const Eigen::VectorXd& linear) const;
  /// H gradient, H the inverse curvature about a solution; that at z^ where it holds none. `moved`: C
  /// gradient.
  Eigen::VectorXd inverse_curvature(const Solution& solution, const Eigen::VectorXd& gradient,
                                    Eigen::VectorXd moved) const;

 private:
  struct Unknowns;
  struct Terms;
  struct Pattern;
  void add_mixed(Eigen::Index weak, Terms& terms) const;
  void keep(Terms terms);
  Eigen::VectorXd products(const Eigen::VectorXd& x) const;
  Eigen::MatrixXd slopes(const Eigen::VectorXd& x) const;
  Eigen::VectorXd load_at(const Unknowns& at, const Eigen::VectorXd& of_errors) const;
  Unknowns error_of(const Unknowns& at, const Unknowns& start, const Eigen::VectorXd& of_errors) const;
  static Unknowns solved(const Eigen::PartialPivLU<Eigen::MatrixXd>& slope, const Unknowns& error);
  Eigen::MatrixXd slope_at(const Unknowns& at, const Eigen::VectorXd& of_errors) const;
  Eigen::MatrixXd curvature_at(const Unknowns& at, const Eigen::VectorXd& of_errors) const;

  const RepeatedCampaign& campaign_;
  std::vector<Eigen::Index> which_;
  std::vector<Eigen::Index> owner_;  ///< of every product, the weak parameter that it has as a factor
  std::vector<Eigen::Index> rows_;   ///< observations that feel the products
  Eigen::MatrixXd weighed_;          ///< Sigma^-1 Q, rows_ x products
  Eigen::MatrixXd features_;         ///< F, parameters x products; the weak parameters' come first
  Eigen::MatrixXd coupling_;         ///< G, parameters x products
  Eigen::MatrixXd strength_;         ///< Q^T Sigma^-1 Q
  Eigen::MatrixXd of_unknowns_;      ///< C [F G], parameters x 2 products
  Eigen::MatrixXd among_;            ///< [F G]^T C [F G]
};

}  // namespace volcal
