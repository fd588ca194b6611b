#pragma once
/// What a result tells of an adjustment besides its parameters: functions, the identified model, temperature.

#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/identify/solve/normals/datum.h"
#include "volcal/identify/solve/priors/smoothing.h"

namespace volcal {

/// Resolution of every function. `covariance`: of the reduced parameters, smoothing held.
std::vector<FunctionSummary> function_summaries(const Campaign& campaign, const ModelSpec& spec,
                                                const DatumSpace& datum,
                                                const std::vector<SmoothingTerm>& terms,
                                                const Eigen::MatrixXd& covariance);

/// Root mean square standard uncertainty of a function over its measured travel, or of a scalar parameter, by
/// the layout and covariance of the result; m or rad.
double mean_uncertainty(const Campaign& campaign, const FitResult& result, const MachineError& error);

/// Gives the rank report's errors the uncertainty and resolution of the result, from its layout, covariance
/// and functions, in place of the rank analysis' wide priors.
void complete_observability(const Campaign& campaign, FitResult& result);

/// `spec` with explicit knots and the values of `parameters`; can be loaded again.
ModelSpec identified_model(const ModelSpec& spec, const Machine& machine, const ParameterLayout& layout,
                           const Eigen::VectorXd& parameters);

/// Ranges of temperatures, time and feed that the readings were recorded with.
RecordedConditions recorded_conditions(const Campaign& campaign);

/// Of the noise groups at these scales. `group_of_channel`: per setup and channel.
std::vector<VarianceComponent> variance_components(
    const std::vector<std::string>& groups, const std::vector<double>& scale,
    const std::vector<ResidualRecord>& records,
    const std::vector<std::vector<std::size_t>>& group_of_channel);
/// Adds chi2 and redundancy of independent readings.
void add_white_squares(const std::vector<ResidualRecord>& records, NoiseSummary& noise);

/// Sets the temperature that the result's functions hold for.
void summarise_temperature(const Campaign& campaign, FitResult& result);

}  // namespace volcal
