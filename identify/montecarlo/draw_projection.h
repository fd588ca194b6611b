#pragma once
/// From deviations of the parameters to standardised deviations t = (y - y^) / u of the quantities, for
/// batches of draws: one matrix product, then the sizes of the volumes, which are not linear but follow from
/// linear columns of their own, beside those of the quantities.
///
/// Linear draws are drawn among the quantities: with W W^T = C of the parameters and A the projection, A^T W
/// n of standard normal n and R^T n of the triangular factor W^T A = Q R are distributed alike, as Q^T n is
/// standard normal (Golub and Van Loan 2013, 5.2). R has no more rows than there are quantities.

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "volcal/identify/montecarlo/quantities.h"
#include "volcal/identify/montecarlo/repeated_campaign.h"

namespace volcal {

class DrawProjection {
 public:
  /// Both must outlive the object.
  DrawProjection(const RepeatedCampaign& campaign, const QuantitySet& quantities);

  Eigen::Index quantities() const { return unit_.size(); }
  /// What t is in units of: u by linear propagation; where that is 0 (the size of a volume without errors),
  /// the root mean square u in the volume. SI.
  const Eigen::ArrayXd& unit() const { return unit_; }
  const Eigen::ArrayXd& u_linear() const { return u_linear_; }
  const Eigen::ArrayXd& bias_linear() const { return bias_linear_; }

  /// t, draws x quantities, of deviations z - z^, parameters x draws.
  Eigen::MatrixXd of(const Eigen::MatrixXd& deviations) const;
  /// R: what linear draws are made by.
  const Eigen::MatrixXd& linear_factor() const { return of_normals_; }
  /// t of linear draws (RepeatedCampaign::draw_linear), first ... first + count.
  Eigen::MatrixXd of_linear_draws(std::uint64_t seed, std::uint64_t first, Eigen::Index count) const;

 private:
  /// The rows of the quantities, and after them those of the volumes.
  Eigen::MatrixXd all_rows() const;
  void set_unit();
  /// The columns of the quantities, with the sizes that follow from those of the volumes.
  Eigen::MatrixXd with_sizes(Eigen::MatrixXd columns) const;

  const RepeatedCampaign& campaign_;
  const QuantitySet& set_;
  Eigen::ArrayXd u_linear_;
  Eigen::ArrayXd bias_linear_;
  Eigen::ArrayXd unit_;
  Eigen::MatrixXd projection_;     ///< parameters x columns
  Eigen::MatrixXd of_normals_;     ///< upper factor of linear root^T projection
  Eigen::MatrixXd of_amplitudes_;  ///< response^T projection
  Eigen::RowVectorXd offset_;      ///< bias^T projection
};

}  // namespace volcal
