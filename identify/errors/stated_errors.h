#pragma once
/// Errors that are stated and not identified: the values of a model file as a result without uncertainty, so
/// that tables, compensations and budgets can be had of them (ISO/TR 16907:2015, 9.2.4 g).

#include <Eigen/Core>
#include <string>

#include "volcal/identify/result/result.h"

namespace volcal {

/// Functions with coefficients, known locations and effects with their amplitudes; what has no value is zero.
/// Beyond model.measured errors keep their last value. No covariance. What model.conditions says stands for
/// the campaign; without it temperatures that effects name are assumed at 20 degC, time and feed at 0, until
/// they are stated.
FitResult stated_result(const Machine& machine, const ModelSpec& model);

/// Adds to a stated result the displacement of a tool's offset, m.
void state_tool_error(const std::string& tool, const Eigen::Vector3d& offset_error, FitResult& result);

/// Whether a model states an error: a function with coefficients, a known location, an effect.
bool states_errors(const ModelSpec& model);

/// Those that count as nothing where no fit follows.
std::vector<EffectSpec> effects_without_amplitude(const ModelSpec& model);

/// Throws InputError where it states none, and for an effect without an amplitude, which would count as
/// nothing.
void require_stated_errors(const ModelSpec& model);

}  // namespace volcal
