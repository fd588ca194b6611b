#pragma once
/// From deviations of the parameters to standardised deviations t = (y - y^) / u of the quantities, for
/// batches of draws: one matrix product, then the sizes of the volumes, which are not linear.

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
  /// the root mean square u of the volume. SI.
  const Eigen::ArrayXd& unit() const { return unit_; }
  const Eigen::ArrayXd& u_linear() const { return u_linear_; }
  const Eigen::ArrayXd& bias_linear() const { return bias_linear_; }

  /// t, draws x quantities, of deviations z - z^, parameters x draws.
  Eigen::ArrayXXd of(const Eigen::MatrixXd& deviations) const;
  /// t of draws among the parameters (RepeatedCampaign::draw_linear), first ... first + count.
  Eigen::ArrayXXd of_linear_draws(std::uint64_t seed, std::uint64_t first, Eigen::Index count) const;

 private:
  Eigen::ArrayXXd finished(Eigen::MatrixXd product) const;

  const RepeatedCampaign& campaign_;
  const QuantitySet& set_;
  Eigen::ArrayXd u_linear_;
  Eigen::ArrayXd bias_linear_;
  Eigen::ArrayXd unit_;
  Eigen::MatrixXd projection_;     ///< parameters x (quantities, vectors of the volumes in m)
  Eigen::MatrixXd of_normals_;     ///< linear root^T projection
  Eigen::MatrixXd of_amplitudes_;  ///< response^T projection
  Eigen::RowVectorXd offset_;      ///< bias^T projection
};

}  // namespace volcal
