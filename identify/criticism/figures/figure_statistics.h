#pragma once
/// What plots of a diagnosis are computed from: means in bins with the noise they have, autocorrelation,
/// partial residuals. Sums over all observations, so that no plot grows with the number of readings.

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/figure_data.h"
#include "volcal/identify/criticism/projection/projector.h"
#include "volcal/identify/noise/noise_model.h"

namespace volcal {

/// Bin of every observation: `count` bins of equal width over the range of `abscissa`; not-a-number = -1.
std::vector<int> equal_bins(const Eigen::VectorXd& abscissa, int count);
/// Means sum d_i v_i / sum d_i^2 over the observations of a bin (-1 = in none): what they say of something of
/// which each feels `felt` = d; empty = 1, the plain mean. First their variance under the noise model, before
/// any fit.
std::vector<double> mean_variance(const NoiseData& data, std::span<const NoiseParameters> noise,
                                  const std::vector<int>& bin, int count, const Eigen::VectorXd& felt = {});
/// `centre` of each bin is the mean of its abscissae; bins whose observations feel less than 3 % of it on
/// average are left out.
BinnedMean binned_mean(const Eigen::VectorXd& abscissa, const Eigen::VectorXd& value,
                       const std::vector<int>& bin, const std::vector<double>& variance,
                       const Eigen::VectorXd& felt = {});

/// `whitened`: as Whitener::whiten() leaves them, at their observations. Observations that are left out do
/// not count; lags with fewer than 30 pairs are left out.
Autocorrelation autocorrelation(const NoiseData& data, std::span<const NoiseParameters> noise,
                                std::size_t group, const Eigen::VectorXd& residual,
                                const Eigen::VectorXd& whitened);

/// Residuals and driver of a candidate after both have been regressed on the rest of the model, whitened: the
/// slope of one against the other is the candidate's amplitude (added-variable plot; Cook and Weisberg 1982,
/// Residuals and Influence in Regression, 2.3.2). Of several columns the driver is their estimated
/// combination a/|a|, and the slope |a|. 0 where an observation is left out.
struct PartialRegression {
  Eigen::VectorXd driver;
  Eigen::VectorXd residual;
  double slope = 0.0;
  double u = 0.0;
};

/// `rest` holds the model without the candidate, `accepted` the columns that it has accepted; `data` is what
/// `rest` was made with.
PartialRegression partial_regression(const NoiseProblem& problem, const NoiseData& data,
                                     std::span<const NoiseParameters> noise, const Projector& rest,
                                     std::span<const Eigen::MatrixXd> accepted,
                                     const Eigen::MatrixXd& candidate);

/// What a model leaves of the residuals: residual - [J accepted] x, not whitened.
Eigen::VectorXd left_over(const NoiseProblem& problem, std::span<const Eigen::MatrixXd> accepted,
                          const Eigen::VectorXd& column, const Eigen::VectorXd& parameters);

}  // namespace volcal
