#pragma once
/// Estimates of drawn campaigns by the adjustment itself: a campaign of its own with the drawn readings, the
/// measurement model bound to it anew, and the solvers of a fit (minimise.h; correlated_adjustment.h where
/// the noise is more than white), with the noise and the smoothing of the fit. What the model holds fixed
/// during a minimisation is renewed as in a fit. It shares no step with the linear and the chord path and is
/// what they are held to.

#include <Eigen/Core>

#include "volcal/identify/montecarlo/repeated_campaign.h"
#include "volcal/identify/solve/normals/minimise.h"

namespace volcal {

/// Of one thread.
class CampaignRefit {
 public:
  /// `campaign` must outlive the object.
  explicit CampaignRefit(const RepeatedCampaign& campaign);

  struct Outcome {
    Eigen::VectorXd deviation;  ///< z - z^, without roughness
    int iterations = 0;
    bool converged = false;
  };
  Outcome solve(const CampaignDraw& draw);

 private:
  void set_readings(const Eigen::VectorXd& errors);
  void renew(const Eigen::VectorXd& z);

  const RepeatedCampaign& repeated_;
  Campaign campaign_;
  MeasurementModel model_;
  ReadingIndex index_;
  DatumSpace datum_;
  std::vector<double> weight_;
  CampaignNoise noise_;
};

}  // namespace volcal
