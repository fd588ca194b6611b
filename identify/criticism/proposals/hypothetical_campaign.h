#pragma once
/// A campaign with setups that were not measured, linearised where the campaign's own fit ended.

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "volcal/identify/criticism/proposals/candidates/candidate_measurements.h"
#include "volcal/identify/noise/noise_model.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/normals/datum.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

/// What n further observations add to a linear model of p parameters (linear_model.h).
struct HypotheticalRows {
  Eigen::MatrixXd model;               ///< n x p, derivatives to the parameters that the campaign has
  Eigen::MatrixXd nuisance;            ///< n x q, to those that come with the new setups
  Eigen::VectorXd nuisance_precision;  ///< q, of their priors
  Eigen::MatrixXd sensitivity;         ///< n x kDisturbances
  NoiseData data;
};

class HypotheticalCampaign {
 public:
  /// `result` must come from fit() of the campaign. `noise_groups`: those of the noise model; others follow
  /// in the order in which they first appear. Throws InputError when a setup cannot be used.
  HypotheticalCampaign(const Campaign& campaign, const FitResult& result,
                       std::vector<std::string> noise_groups, std::vector<ExtraMeasurement> measurements);
  HypotheticalCampaign(const HypotheticalCampaign&) = delete;
  HypotheticalCampaign& operator=(const HypotheticalCampaign&) = delete;

  const std::vector<ExtraMeasurement>& measurements() const { return measurements_; }
  const std::vector<std::string>& noise_groups() const { return noise_groups_; }
  HypotheticalRows rows(std::size_t measurement) const;
  /// Columns of an effect in the observations of rows().
  Eigen::MatrixXd columns(std::size_t measurement, const HypotheticalRows& rows, const Effect& effect,
                          const Eigen::VectorXd& shape) const;

 private:
  struct Stretch {
    std::size_t first = 0;  ///< setup of the extended campaign
    std::size_t count = 0;
  };
  /// Of observations one after the other.
  struct Derivatives {
    std::vector<Eigen::VectorXd> model;        ///< to the reduced parameters of the extended campaign
    std::vector<Eigen::VectorXd> sensitivity;  ///< to disturbances
  };

  Campaign extended(const Campaign& campaign);
  std::size_t group_of(std::size_t setup, int channel) const;
  void map_parameters(const Campaign& campaign, const FitResult& result);
  void observe(std::size_t setup, Derivatives& derivatives, NoiseData& data) const;
  /// Those of new setups that any of the observations depends on.
  std::vector<Eigen::Index> new_parameters(const Derivatives& derivatives) const;

  std::vector<ExtraMeasurement> measurements_;
  std::vector<std::string> noise_groups_;
  std::vector<Stretch> stretches_;
  Campaign campaign_;
  MeasurementModel model_;
  Eigen::VectorXd parameters_;       ///< raw, of the extended campaign
  std::vector<DatumSpace> datum_;    ///< one
  std::vector<Eigen::Index> place_;  ///< reduced parameter -> that of the campaign; -1 = new
  Eigen::VectorXd new_precision_;    ///< per reduced parameter
  Eigen::Index known_parameters_ = 0;
  std::vector<SetupView> views_;
};

}  // namespace volcal
