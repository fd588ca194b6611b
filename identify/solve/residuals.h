#pragma once
/// Residuals, redundancy numbers and Baarda's w-test (Baarda 1968, A testing procedure for use in geodetic
/// networks) of an adjusted campaign.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/normals/normal_equations.h"

namespace volcal {

/// Two-sided critical value of w such that the chance of flagging any of `observations` good readings is
/// `risk`.
double outlier_critical_value(std::size_t observations, double risk);

/// Records of all observations in setup, row, channel order. `sigma` per observation as used in the
/// adjustment; `weight` 0 marks removed ones. `covariance`: of the raw parameters; empty = residuals only,
/// redundancy 1.
std::vector<ResidualRecord> residual_records(const ReadingIndex& index, const std::vector<double>& sigma,
                                             const std::vector<double>& weight,
                                             const Eigen::VectorXd& parameters,
                                             const Eigen::MatrixXd& covariance, double critical_value,
                                             int threads);

/// What leaves next: of every setup the flagged reading with the largest |w|, and those with at least the
/// share `nearly` of it; nothing of a setup that has lost more than the share `most` of its observations.
std::vector<std::size_t> worst_outliers(const std::vector<ResidualRecord>& records, double nearly,
                                        double most);

/// Chi-squared, redundancy, RMS and largest residual per setup; the last two over the channels of the first
/// one's unit (of a tracker the lengths). `stated_sigma` per observation. Throws InputError for an unknown
/// instrument.
std::vector<SetupSummary> setup_summaries(const Campaign& campaign,
                                          const std::vector<ResidualRecord>& records,
                                          const std::vector<double>& stated_sigma);

}  // namespace volcal
