#pragma once
/// Adjustment of a campaign whose noise is correlated: generalised least squares.
///
/// With the noise model Sigma (identify/noise/noise_model.h) estimated by restricted maximum likelihood about
/// the white adjustment, and the prior (P, m),
///
///   M = J^T Sigma^-1 J,   g = J^T Sigma^-1 (predicted - reading),   z <- z - (M + P)^-1 (g + P (z - m))
///
/// until the step is negligible; (M + P)^-1 is the covariance of z (Rao 1973, Linear Statistical Inference,
/// 4a.2, with the prior as further observations). Smoothing is chosen by evidence from the same whitened
/// equations. Sums are made as the filter passes over the readings: nothing of their number times the
/// parameters is stored.

#include <functional>
#include <vector>

#include "volcal/identify/noise/noise_estimate.h"
#include "volcal/identify/solve/campaign_noise.h"
#include "volcal/identify/solve/priors/evidence.h"

namespace volcal {

/// Restricted maximum likelihood about an adjustment. Of more than 30,000 observations, or 300 setups, an
/// even sample of whole sequences speaks for all. `previous`: the estimate for nearly the same problem, or
/// null.
NoiseEstimate estimate_noise(const MeasurementModel& model, const DatumSpace& datum,
                             const CampaignNoise& noise, const Eigen::VectorXd& z, const GaussianPrior& prior,
                             const NoiseOptions& options, const NoiseEstimate* previous = nullptr);

/// Whether more than independent noise in proportion to the stated sigma is supported for any instrument.
bool is_more_than_white(const NoiseEstimate& estimate);

/// sqrt(Sigma_ii) per observation, m or rad, for given stated sigma (removed observations included).
std::vector<double> total_sigma(const NoiseData& noise, const std::vector<double>& stated_sigma,
                                const std::vector<NoiseParameters>& parameters);

class WhitenedCampaign {
 public:
  /// Everything given must outlive the object. `parameters`: per instrument of `noise`.
  WhitenedCampaign(const MeasurementModel& model, const DatumSpace& datum, const CampaignNoise& noise,
                   const std::vector<NoiseParameters>& parameters, int threads);

  /// Per instrument, about the reduced parameters z: M, g, squares of the whitened errors.
  std::vector<NoiseGroupEquations> equations(const Eigen::VectorXd& z) const;
  int threads() const { return threads_; }

 private:
  void fill(const std::vector<std::size_t>& observations, const Eigen::VectorXd& raw,
            const TabulatedFunctions& tabulated, Eigen::Ref<Eigen::MatrixXd> columns) const;

  const MeasurementModel& model_;
  const DatumSpace& datum_;
  const CampaignNoise& noise_;
  Whitener whitener_;
  int threads_;
};

struct CorrelatedAdjustment {
  bool converged = false;
  int iterations = 0;
  double cost = 0.0;           ///< half the whitened squares and the prior's, at the solution
  double squares = 0.0;        ///< of the whitened residuals
  double redundancy = 0.0;     ///< observations minus what the parameters take
  Eigen::MatrixXd covariance;  ///< of z
};

/// Minimises from z, which holds the result. Smoothing is renewed in the first `evidence_rounds` iterations;
/// `renew` is called after the first steps with the new z, to renew what the model holds fixed, and may set z
/// back.
CorrelatedAdjustment adjust_correlated(const WhitenedCampaign& campaign, const GaussianPrior& prior,
                                       int evidence_rounds,
                                       const std::function<void(Eigen::VectorXd& z)>& renew,
                                       std::vector<SmoothingTerm>& terms, Eigen::VectorXd& z);

}  // namespace volcal
