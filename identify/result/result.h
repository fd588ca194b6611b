#pragma once
/// What an identification returns: the identified machine with its covariance, every residual, and what the
/// data could and could not determine. Plain data, SI; written to files by identify/io, drawn by
/// identify/report.

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volcal/identify/noise/noise_estimate.h"
#include "volcal/identify/statistics/normal.h"
#include "volcal/model/description/finding.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/description/machine_error.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/description/recorded_conditions.h"
#include "volcal/model/description/units.h"
#include "volcal/model/observation/parameters.h"

namespace volcal {

enum class FitStatus { Ok, LackOfFit, RankDeficient, NotConverged };
std::string_view to_string(FitStatus status);

/// One observation (one channel of one reading) with its fit. SI; standardised values are dimensionless.
struct ResidualRecord {
  std::size_t setup = 0;  ///< index into FitResult::setups
  std::size_t row = 0;    ///< index into the setup's readings
  int channel = 0;
  std::int64_t source_line = 0;  ///< 1-based line of the file
  double reading = 0.0;
  double predicted = 0.0;
  double sigma = 0.0;       ///< total standard deviation in the last adjustment: sqrt(Sigma_ii)
  double redundancy = 0.0;  ///< (Sigma_ii - j Cov j^T) / Sigma_ii, 0..1: Baarda's number for white noise
  double w = 0.0;           ///< residual / (sigma sqrt(redundancy)), standard normal; 0 without redundancy
  bool flagged = false;     ///< |w| above the critical value
  bool removed = false;     ///< taken out of the adjustment
  bool left_out = false;    ///< the campaign asked for it: removed, and in no figure

  double residual() const { return reading - predicted; }
};

/// Fit of one setup.
struct SetupSummary {
  std::string name;
  std::string instrument;
  std::string tool;
  std::string reading_unit;  ///< edge unit of the residuals: "um" or "urad"
  std::size_t observations = 0;
  double chi2 = 0.0;          ///< with the stated sigma
  double redundancy = 0.0;    ///< sum of redundancy numbers
  double rms_residual = 0.0;  ///< SI
  double max_residual = 0.0;  ///< SI
  std::string fingerprint;    ///< of its readings (fitted_readings.h); empty in older results
};

/// Variance component of one instrument: the stated sigma must be multiplied by `scale` (1 = as stated). With
/// correlated noise that of its independent part.
struct VarianceComponent {
  std::string instrument;  ///< noise group (channels.h)
  double scale = 1.0;
  double scale_u = 0.0;  ///< standard uncertainty of the scale
  double redundancy = 0.0;
  std::size_t observations = 0;
};

/// The noise that the adjustment's weights stand for (noise_model.h), by restricted maximum likelihood.
struct NoiseSummary {
  bool estimated = false;        ///< false: independent readings were assumed, nothing else was tried
  bool more_than_white = false;  ///< weights are Sigma^-1 of `rows`; else 1 / sigma^2 of independent readings
  std::vector<std::string> groups;  ///< names of the noise groups (channels.h)
  std::vector<NoiseRow> rows;       ///< of all instruments; empty when not estimated
  double chi2 = 0.0;                ///< of the whitened residuals, with the estimated noise
  double dof = 0.0;                 ///< observations minus what the parameters take
};

/// How well one error (function, location error, amplitude of an effect) is seen.
struct Observability {
  MachineError symbol;
  bool visible = true;
  double visible_fraction = 0.0;  ///< share of the error's signal that no other parameter can imitate, 0..1
  double u_rms = 0.0;             ///< root mean square standard uncertainty over the measured travel, SI
  double effective_parameters = 0.0;  ///< that the readings determine; NaN when not visible
  std::optional<Finding> cause = {};  ///< when not visible: why, and what to measure ("rank.not-visible...")
};

/// What the data cannot determine.
struct RankReport {
  int parameters = 0;  ///< after the datum
  int rank = 0;
  std::vector<Finding> invisible;      ///< one per error that is not visible: "rank.not-visible..."
  std::vector<Finding> held_by_prior;  ///< nuisance parameters held at their guess by a weak default prior
  std::vector<Observability> errors;
};

/// Resolution chosen for one function.
struct FunctionSummary {
  ErrorSymbol symbol;
  int intervals = 0;
  bool smoothed = false;  ///< smoothing prior in force (knots = "auto")
  std::string prior;      ///< kind that its spectrum is about (function_prior.h); empty = not smoothed
  double correlation_length = 0.0;    ///< of the prior, m or rad; 0 = not smoothed
  double effective_parameters = 0.0;  ///< that the readings determine; NaN when the error is not visible
  /// Range of positions with readings, m or rad; the travel where a periodic function was measured over three
  /// quarters of a turn.
  double measured_min = 0.0;
  double measured_max = 0.0;
};

struct Timing {
  std::string stage;
  double seconds = 0.0;
};

struct Adjustment;

/// Which program made a result, when and how; empty where it is not known, as in a program of one's own.
struct Provenance {
  std::string version;  ///< of volcal
  std::string date;     ///< UTC, ISO 8601: "2026-01-31T14:05:09Z"
  std::string command;  ///< as it can be typed again

  bool empty() const { return version.empty() && date.empty() && command.empty(); }
};

struct FitResult {
  FitStatus status = FitStatus::Ok;
  std::vector<Finding> findings;  ///< warnings and explanations for the user; in words: identify/words
  Provenance provenance;

  Machine machine;
  ModelSpec identified;  ///< model with breakpoints, coefficients and squareness; can be loaded again
  ParameterLayout layout;
  Eigen::VectorXd parameters;  ///< SI
  /// Of `parameters`, SI; singular by the datum. Without rows where errors are stated, which have none.
  Eigen::MatrixXd covariance;
  double reference_temperature_degC = kReferenceTemperature_degC;
  bool temperature_is_campaign_mean = false;
  RecordedConditions conditions;
  std::string active_compensations;     ///< while the campaign was measured, in words; empty = not stated
  std::map<AxisName, double> standing;  ///< where rotary axes stood that did not move, rad
  std::string alignment;                ///< frame that it was turned to (alignment.h); empty = the fit's own

  double sigma0 = 0.0;  ///< sqrt(chi2 / dof) with the stated sigma
  double chi2 = 0.0;
  double dof = 0.0;
  double coverage_factor = kCoverageFactor;  ///< U95 = coverage_factor u
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  double outlier_critical_value = 0.0;

  std::vector<SetupSummary> setups;
  std::vector<VarianceComponent> variance_components;
  NoiseSummary noise;
  std::vector<FunctionSummary> functions;
  RankReport rank;
  std::vector<ResidualRecord> residuals;
  std::vector<Timing> timings;
  std::shared_ptr<const Adjustment> adjustment;  ///< adjustment.h; null in a result read from files
};

/// Of one parameter; zero where errors are stated.
double parameter_variance(const FitResult& result, Eigen::Index parameter);
/// Of these parameters; zero where errors are stated.
Eigen::MatrixXd covariance_of(const FitResult& result, const std::vector<int>& parameters);

/// Findings that the fit did not converge or that readings contradict its model: what is made of it is not
/// the whole error.
std::vector<Finding> contradictions(const FitResult& result);

/// First and last position with readings of every axis that has functions, m or rad.
std::map<AxisName, std::pair<double, double>> measured_positions(const FitResult& result);

/// The identified model with the errors of tools' offsets, the expansions of scales, the positions that were
/// measured, where these are not the whole travel, and, where it has effects, the conditions: it says of an
/// error at any position and of any tool what the result says.
ModelSpec model_of_result(const FitResult& result);

}  // namespace volcal
