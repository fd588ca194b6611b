#pragma once
/// An adjusted campaign as a linear model about its solution: what every test of model criticism starts from.
/// Immutable: other smoothing, or further readings in use, give another model, which shares what does not
/// change.

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/scan_direction.h"
#include "volcal/identify/noise/noise_model.h"
#include "volcal/identify/noise/restricted_likelihood.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/campaign_noise.h"
#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/identify/solve/priors/smoothing.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

/// Observations stand in setup, row, channel order. SI.
class LinearModel {
 public:
  /// `result` must come from fit() of this campaign; the campaign must outlive the object.
  LinearModel(const Campaign& campaign, const FitResult& result);
  /// Of some observations alone: `chosen`, ascending, are their numbers in result.residuals.
  LinearModel(const Campaign& campaign, const FitResult& result, const std::vector<std::size_t>& chosen);

  using Observation = ObservationPlace;

  const Campaign& campaign() const { return fixed_->campaign; }
  const MeasurementModel& model() const { return fixed_->model; }
  std::size_t size() const { return observations().size(); }
  const std::vector<Observation>& observations() const { return fixed_->observations; }
  /// Of the campaign's commanded positions.
  const MeasuredRange& measured(AxisName axis) const { return fixed_->measured[index_of(axis)]; }
  const std::vector<SetupView>& views() const { return fixed_->views; }
  const std::vector<std::string>& noise_groups() const { return fixed_->noise_groups; }
  /// Derivatives to the parameters in datum coordinates, residuals (reading minus prediction), priors and
  /// what the noise model needs. Observations that are left out have an infinite sigma.
  const NoiseProblem& problem() const { return *problem_; }

  /// Residuals that take along what is not linear at a correction x of the parameters: y - f(z + x) + J x, f
  /// by the exact transforms. With them the solution of the linear model is a step of Newton's method whose
  /// derivatives are kept.
  Eigen::VectorXd exact_residual_at(const Eigen::VectorXd& correction) const;
  LinearModel with_residual(Eigen::VectorXd residual) const;

  /// Observations that are left out: at first those that the fit removed.
  const std::vector<std::size_t>& removed() const { return removed_; }
  /// With some of removed() in use again: a fit that lacks an effect takes what the effect moves most for
  /// outliers.
  LinearModel with_reinstated(const std::vector<std::size_t>& observations) const;

  /// Smoothing of functions that have as many knots as the readings can separate; part of the priors of
  /// problem().
  const std::vector<SmoothingTerm>& smoothing() const { return smoothing_; }
  LinearModel with_smoothing(std::vector<SmoothingTerm> smoothing) const;
  /// With smoothing by evidence (smoothing.h) from [J G y]^T Sigma^-1 [J G y], G columns of effects without
  /// prior: a fit that lacks an effect takes part of it for detail of the functions, or for noise that hides
  /// detail.
  LinearModel smoothed(const Eigen::MatrixXd& gram, std::size_t observations, int threads) const;
  /// With the coefficients of a surface as further parameters, the last, under its prior (surface_prior.h).
  LinearModel with_surface(const Effect& effect) const;
  /// Without the surface of a term of smoothing().
  LinearModel without_surface(std::size_t term) const;
  /// What the rest of the model, and effects that were added to it, can imitate of surfaces is theirs. `gram`
  /// as for smoothed().
  LinearModel with_imitated_left_to_the_rest(const Eigen::MatrixXd& gram) const;
  /// Shares of functions of the surface of a term of smoothing() (coefficients, one column each) that only
  /// the smoothness of error functions keeps from these.
  Eigen::VectorXd imitated_unless_smoothed(const Eigen::MatrixXd& gram, std::size_t term,
                                           const Eigen::MatrixXd& functions) const;
  /// Of observations(), those that are left out as well.
  const std::vector<double>& stated_sigma() const { return fixed_->stated_sigma; }
  /// Of the fit's outlier test.
  double outlier_critical_value() const { return fixed_->outlier_critical_value; }

  /// Boundaries 0 ... N of the setups among the observations.
  const std::vector<Eigen::Index>& parts() const { return fixed_->parts; }
  /// Columns of the readings that an effect's amplitudes would add, rows of one setup: observations x
  /// amplitudes.
  void columns(const Effect& effect, const Eigen::VectorXd& shape, std::size_t setup,
               Eigen::Ref<Eigen::MatrixXd> out) const;
  /// Adds the transpose of these columns times `rows`, of the same observations, without making them: an
  /// effect moves a reading by its drivers times the reading's sensitivity to what they drive. `sum`:
  /// amplitudes x columns of `rows`.
  void add_products(const Effect& effect, const Eigen::VectorXd& shape, std::size_t setup,
                    const Eigen::Ref<const Eigen::MatrixXd>& rows, Eigen::Ref<Eigen::MatrixXd> sum) const;
  double sensitivity(Eigen::Index observation, int disturbance) const {
    return fixed_->sensitivity(observation, disturbance);
  }
  /// Derivative of every observation to the displacement of the functional point along a direction of the
  /// workpiece, or to the reading itself (the beam's).
  Eigen::VectorXd direction(ScanDirection direction) const;
  /// The same to an error motion.
  Eigen::VectorXd motion(ErrorSymbol symbol) const;

 private:
  struct Fixed {
    Fixed(const Campaign& of, const FitResult& result);
    void find_sensitivity(const Eigen::VectorXd& parameters);

    const Campaign& campaign;
    MeasurementModel model;
    std::array<MeasuredRange, kAxisCount> measured;
    std::vector<Observation> observations;
    std::vector<Eigen::Index> parts;
    std::vector<std::string> noise_groups;
    std::vector<SetupView> views;
    Eigen::Matrix<double, Eigen::Dynamic, kDisturbances> sensitivity;
    std::vector<double> stated_sigma;
    double outlier_critical_value;
  };

  LinearModel(const Campaign& campaign, const FitResult& result, const std::vector<std::size_t>* chosen);

  /// `problem` becomes that of this model.
  void set_smoothing(std::vector<SmoothingTerm> smoothing, const std::shared_ptr<NoiseProblem>& problem);

  /// That and `size` further parameters without prior, at zero.
  GaussianPrior base_prior_of(Eigen::Index size) const;
  Eigen::VectorXd reduced_of(Eigen::Index size) const;

  std::shared_ptr<const Fixed> fixed_;
  GaussianPrior base_prior_;  ///< of the parameters, without smoothing
  Eigen::VectorXd reduced_;   ///< where the model is linearised
  std::shared_ptr<const NoiseProblem> problem_;
  std::vector<SmoothingTerm> smoothing_;
  std::vector<std::size_t> removed_;
};

/// The same residuals with some observations left out (their sigma made infinite).
NoiseData without(const NoiseData& data, const std::vector<bool>& left_out);

}  // namespace volcal
