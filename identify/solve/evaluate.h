#pragma once
/// A given model on readings that did not make it: error functions frozen, only the campaign's nuisance
/// parameters (stations, dead paths, alignments, tool and scale errors with priors) re-estimated. What a
/// model says of a tool's offset is where its prior stands, and held where the machine file calls it exact.

#include <memory>
#include <optional>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// The machine without errors.
ModelSpec nominal_model();
/// The model with every function that has no coefficients switched off, so that it predicts without a fit.
ModelSpec frozen_model(const ModelSpec& model);

struct Evaluation {
  std::vector<ResidualRecord>
      residuals;  ///< sigma as stated; redundancy and w against the re-estimated nuisance
  std::vector<double>
      model_u;  ///< standard uncertainty of each prediction by the model, SI; 0 without covariance
  Eigen::VectorXd
      parameters_u;  ///< of the raw nuisance parameters by the model alone; empty without covariance
  std::vector<SetupSummary> setups;
  double chi2 = 0.0;
  double dof = 0.0;
  ParameterLayout layout;
  Eigen::VectorXd parameters;  ///< raw
  std::shared_ptr<const Adjustment> adjustment;
};

/// One per rotary axis that moves in the campaign and has no errors in a model that states some.
std::vector<Finding> missing_rotary_errors(const Campaign& campaign, const ModelSpec& model);

/// "compensation.active-differ" where other compensations were active while the campaign was measured than
/// while the errors were identified.
std::vector<Finding> differing_compensations(const Campaign& campaign, const FitResult& identified);

/// "errors.held-beyond-readings" of every axis on which the campaign has readings beyond model.measured, and
/// "errors.faded-beyond-readings" of every curve or surface with readings beyond those it was drawn from.
std::vector<Finding> held_beyond_measured(const Campaign& campaign, const ModelSpec& model);

/// A frozen model: its errors and the expansions of scales are held (of those that it does not know, what the
/// machine file states), and what comes with setups and uncertain tools is estimated. Beyond model.measured
/// errors keep their last value, as in tables.
/// `identified` supplies the covariance when `model` is its identified model; null = predictions without u.
/// Rotary axes that move in the campaign and of which the model has no errors add the wide prior of these to
/// that u (unknown_rotary_axes.h), and expansions that the model does not know what the machine file says.
/// Throws InputError when the campaign does not fit the model's machine.
Evaluation evaluate_model(const Campaign& campaign, const ModelSpec& model,
                          const FitResult* identified = nullptr, int threads = 0);

/// An identified model on a campaign as if a fit had ended there, with the noise of `identified`: what
/// criticises a fit can then criticise it. Of its errors nothing is open.
FitResult as_fitted(const Evaluation& evaluation, const FitResult& identified);

/// Size of errors of one kind, lengths (m) or angles (rad); 0 without any.
struct ErrorSize {
  std::size_t count = 0;
  double rms = 0.0;
  double max = 0.0;
};

struct ErrorSizes {
  ErrorSize lengths;
  ErrorSize angles;
};

/// The channels of a vector reading are one value, |e|; angles apart. Readings that are left out do not
/// count.
ErrorSizes error_sizes(const Campaign& campaign, const std::vector<ResidualRecord>& records);

/// Figures of `volcal validate`. Vectors count as one value, |e|; angles apart.
struct ValidationFigures {
  double rms_before = 0.0;  ///< m
  double rms_after = 0.0;
  double max_before = 0.0;
  double max_after = 0.0;
  double angle_rms_before = 0.0;  ///< rad
  double angle_rms_after = 0.0;
  double angle_max_before = 0.0;
  double angle_max_after = 0.0;
  std::size_t lengths = 0;
  std::size_t angles = 0;
  double reduced_chi2 = 0.0;  ///< after, with u_model^2 + sigma^2
  double coverage95 = 0.0;    ///< share of readings inside +-1.96 sqrt(u_model^2 + sigma^2)
};

struct Validation {
  Evaluation before;
  Evaluation after;
  ValidationFigures figures;
  std::vector<Finding> contradicted;  ///< stated values of the campaign, by the readings with the model
};

Validation validate(const Campaign& campaign, const FitResult& result, int threads = 0);

}  // namespace volcal
