#pragma once
/// An adjusted campaign as a linear model about its solution: what every test of model criticism starts from.

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "volcal/identify/noise/noise_model.h"
#include "volcal/identify/noise/restricted_likelihood.h"
#include "volcal/identify/solve/campaign_noise.h"
#include "volcal/identify/solve/result.h"
#include "volcal/identify/solve/smoothing.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

/// Observations stand in setup, row, channel order. SI.
class LinearModel {
 public:
  /// `result` must come from fit() of this campaign; both must outlive the object.
  LinearModel(const Campaign& campaign, const FitResult& result);

  using Observation = ObservationPlace;

  const Campaign& campaign() const { return campaign_; }
  const MeasurementModel& model() const { return model_; }
  std::size_t size() const { return observations_.size(); }
  const std::vector<Observation>& observations() const { return observations_; }
  const std::vector<SetupView>& views() const { return views_; }
  const std::vector<std::string>& noise_groups() const { return noise_groups_; }
  /// Derivatives to the parameters in datum coordinates, residuals (reading minus prediction), priors and
  /// what the noise model needs. Readings that the fit removed have an infinite sigma.
  const NoiseProblem& problem() const { return problem_; }

  /// Observations that are left out: at first those that the fit removed.
  const std::vector<std::size_t>& removed() const { return removed_; }
  /// Takes up again those that a better model explains: a fit that lacks an effect takes what the effect
  /// moves most for outliers. Returns how many.
  std::size_t take_up(const std::function<bool(std::size_t observation)>& explained);
  /// Leaves out again all that the fit removed, and smooths as it did.
  void return_to_fit();

  /// Smoothing of functions that have as many knots as the readings can tell apart; goes into the priors of
  /// problem().
  const std::vector<SmoothingTerm>& smoothing() const { return smoothing_; }
  void set_smoothing(std::vector<SmoothingTerm> smoothing);
  /// Chosen by evidence (smoothing.h) from [J G y]^T Sigma^-1 [J G y], G columns of effects without prior: a
  /// fit that lacks an effect takes part of it for detail of the functions, or for noise that hides detail.
  void smooth(const Eigen::MatrixXd& gram, std::size_t observations);
  /// Of all observations, those that are left out as well.
  const std::vector<double>& stated_sigma() const { return stated_sigma_; }
  /// Of the fit's outlier test.
  double outlier_critical_value() const { return outlier_critical_value_; }

  /// Boundaries 0 ... N of the setups among the observations.
  const std::vector<Eigen::Index>& parts() const { return parts_; }
  /// Columns of the readings that an effect's amplitudes would add, rows of one setup: observations x
  /// amplitudes.
  void columns(const Effect& effect, const Eigen::VectorXd& shape, std::size_t setup,
               Eigen::Ref<Eigen::MatrixXd> out) const;
  double sensitivity(Eigen::Index observation, int disturbance) const {
    return sensitivity_(observation, disturbance);
  }
  /// Derivative of every observation to the displacement of the functional point along a direction of the
  /// workpiece (0..2), or to the reading itself (3).
  Eigen::VectorXd direction(int which) const;
  /// The same to an error motion.
  Eigen::VectorXd motion(ErrorSymbol symbol) const;

 private:
  void add_sensitivity(const Eigen::VectorXd& parameters);

  const Campaign& campaign_;
  MeasurementModel model_;
  std::vector<Observation> observations_;
  std::vector<Eigen::Index> parts_;
  std::vector<std::string> noise_groups_;
  std::vector<SetupView> views_;
  Eigen::Matrix<double, Eigen::Dynamic, kDisturbances> sensitivity_;
  NoiseProblem problem_;
  GaussianPrior base_prior_;  ///< of the reduced parameters, without smoothing
  Eigen::VectorXd reduced_;   ///< where the model is linearised
  std::vector<SmoothingTerm> smoothing_as_fitted_;
  std::vector<SmoothingTerm> smoothing_;
  std::vector<double> stated_sigma_;
  std::vector<std::size_t> removed_by_fit_;
  std::vector<std::size_t> removed_;
  double outlier_critical_value_;
};

/// The same residuals with some observations left out (their sigma made infinite).
NoiseData without(const NoiseData& data, const std::vector<bool>& left_out);

}  // namespace volcal
