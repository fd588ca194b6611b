#pragma once
/// A fitted campaign taken again and again: what a draw of a Monte Carlo study is (JCGM 101:2008, clause 5).
///
/// Truth is the identified machine z^, the readings are y = f(z^) + e + G a: f the measurement model with the
/// exact transforms' remainder, e from the noise model of the fit (instrument noise, repeatability, and
/// correlated drift, offsets of lines and a part in proportion to length where it has them), G a effects that
/// the adjustment knows nothing of, with amplitudes a from their distributions. What the adjustment knows
/// beforehand - a station, a tool's offset, a scale's expansion, an instrument's length scale with their
/// standard uncertainties, and how large and rough an error function is - is a statement s about z with
/// covariance P^-1, drawn about the truth: only the difference of statement and truth matters to first order,
/// and the machine stays the identified one. The estimate z is the adjustment's, with the same weights
/// Sigma^-1 and the same P:
///
///   J(z)^T Sigma^-1 (f(z) - y) + P (z - s) = 0                                                        (1)
///
/// and to first order, C = (J^T Sigma^-1 J + P)^-1 at z^,
///
///   z - z^ = C (J^T Sigma^-1 (e + G a) + P (s - z^)),                                                 (2)
///
/// whose covariance without G is C: the covariance of the fit. (It is the sampling by perturbed observations
/// and perturbed prior of Papandreou and Yuille 2010, NIPS 23.)
///
/// `FunctionRoughness::Fixed` leaves the statement about the error functions as the fit has it: the scatter
/// of repeated campaigns on one machine, with what smoothing takes off its functions as a bias, C P_f (m_f -
/// z^). Scatter and bias together stand for what `Drawn` draws, on average over machines; of one machine,
/// neither is its uncertainty.
///
/// What is said of the functions, wide priors on what the readings hardly determine included, and that the
/// smoothing's amplitudes are not known exactly (amplitude_covariance of smoothing.h, part of the covariance
/// of a result), are added to the estimates of all paths in their linear form, z + R n with R R^T = C P_f C +
/// that covariance: readings are linear in the functions to second order, and smoothing is linear. All paths
/// hold the smoothing of the fit.
///
/// SI; parameters are the reduced ones of datum.h; observations stand in setup, row, channel order.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/identify/montecarlo/noise_sampler.h"
#include "volcal/identify/noise/noise_model.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/normals/datum.h"

namespace volcal {

enum class FunctionRoughness { Drawn, Fixed };
enum class DistributionShape { Normal, Rectangular };

/// An effect that acts on the readings and is not in the adjusted model. Every amplitude has expectation 0.
struct Disturbance {
  EffectSpec effect;
  double sigma = 0.0;  ///< standard deviation of every amplitude, SI
  std::string words;   ///< for the user: "station-drift:station P1, u = 0.5 um/h"
  DistributionShape shape = DistributionShape::Normal;
};

struct DrawnSources {
  FunctionRoughness functions = FunctionRoughness::Drawn;
  std::vector<Disturbance> disturbances;
};

/// One draw. Vectors have the size of observations or parameters.
struct CampaignDraw {
  Eigen::VectorXd errors;     ///< of the readings: y - f(z^); 0 where a reading is left out
  Eigen::VectorXd statement;  ///< s - z^
  Eigen::VectorXd roughness;  ///< share of the functions' roughness in the estimate, to be added to it
};

/// Something that scatters the estimates, independent of every other source; root root^T is its share of the
/// covariance of (2).
struct UncertaintySource {
  std::string name;      ///< for the user
  Eigen::MatrixXd root;  ///< parameters x any
};

class RepeatedCampaign {
 public:
  /// `result` must come from fit() of this campaign without a robust loss; both must outlive the object.
  /// Throws InputError when the readings do not determine every error of the model, or for an effect that
  /// cannot act in the campaign.
  RepeatedCampaign(const Campaign& campaign, const FitResult& result, DrawnSources sources);

  Eigen::Index parameters() const { return identified_.size(); }
  Eigen::Index observations() const { return predicted_.size(); }
  const LinearModel& linear_model() const { return linear_; }
  const FitResult& result() const { return result_; }
  const DatumSpace& datum() const { return datum_; }
  const Whitener& whitener() const { return whitener_; }
  const std::vector<NoiseParameters>& noise() const { return noise_; }
  const DrawnSources& sources() const { return sources_; }
  const Eigen::VectorXd& identified() const { return identified_; }                             ///< z^
  const Eigen::VectorXd& predicted() const { return predicted_; }                               ///< f(z^)
  const Eigen::MatrixXd& gain() const { return gain_; }                                         ///< C
  const Eigen::MatrixXd& prior_precision() const { return linear_.problem().prior_precision; }  ///< P

  /// Of (2): root R with R R^T the covariance of all that is normal, expectation, response to amplitudes of
  /// disturbances that are not normal.
  const Eigen::MatrixXd& linear_root() const { return root_; }
  const Eigen::VectorXd& linear_bias() const { return bias_; }
  const Eigen::MatrixXd& response() const { return rectangular_response_; }
  const std::vector<UncertaintySource>& uncertainty_sources() const { return uncertainty_sources_; }

  /// For deviations by (2) that are drawn without their readings, J^T Sigma^-1 e being exactly
  /// N(0, J^T Sigma^-1 J): standard normal numbers, as many as there are rows, and amplitudes of response(),
  /// one column per draw from `first`. Not the draws of the same number of draw().
  void draw_linear(std::uint64_t seed, std::uint64_t first, Eigen::Ref<Eigen::MatrixXd> normals,
                   Eigen::Ref<Eigen::MatrixXd> amplitudes) const;

  CampaignDraw draw(std::uint64_t seed, std::uint64_t number) const;
  /// Draws `first` to first + count, to rounding those of draw().
  std::vector<CampaignDraw> draws(std::uint64_t seed, std::uint64_t first, Eigen::Index count) const;
  /// (2) for draws among the readings, one column each; without the roughness.
  Eigen::MatrixXd linear_estimates(const std::vector<CampaignDraw>& draws) const;

 private:
  void require_determined() const;
  void set_statements();
  void add_disturbances();
  void list_sources();
  void list_noise();
  void list_statements();
  void set_linear_propagation();
  CampaignDraw readings_and_statements(std::uint64_t seed, std::uint64_t number) const;
  bool draws_functions() const { return sources_.functions == FunctionRoughness::Drawn; }

  const FitResult& result_;
  DrawnSources sources_;
  LinearModel linear_;
  DatumSpace datum_;
  Eigen::VectorXd identified_;
  Eigen::VectorXd predicted_;
  std::vector<NoiseParameters> noise_;
  Whitener whitener_;
  NoiseSampler sampler_;
  Eigen::MatrixXd whitened_;  ///< L^-1 J, observations x parameters
  Eigen::MatrixXd gain_;      ///< C
  Eigen::VectorXd stated_;    ///< precision of what is stated of stations, tools, scales
  Eigen::VectorXd fixed_statement_;
  Eigen::MatrixXd roughness_root_;        ///< R
  Eigen::MatrixXd disturbance_columns_;   ///< G, observations x amplitudes
  std::vector<Eigen::Index> amplitudes_;  ///< of every disturbance
  std::vector<double> disturbance_sigma_;
  std::vector<DistributionShape> disturbance_shape_;
  Eigen::MatrixXd disturbance_response_;  ///< of the estimates, times a standard deviation
  std::vector<UncertaintySource> uncertainty_sources_;
  Eigen::MatrixXd root_;
  Eigen::VectorXd bias_;
  Eigen::MatrixXd rectangular_response_;  ///< times a standard deviation
};

}  // namespace volcal
