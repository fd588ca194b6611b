#pragma once
/// Errors that are stated and not identified: the values of a model file as a result without uncertainty, so
/// that tables, compensations and budgets can be had of them (ISO/TR 16907:2015, 9.2.4 g).

#include <Eigen/Core>
#include <string>

#include "volcal/identify/result/result.h"
#include "volcal/model/effects/effect.h"

namespace volcal {

/// Functions with coefficients, known locations, effects with their amplitudes and errors of tools' offsets;
/// what has no value is zero.
/// Beyond model.measured errors keep their last value. No covariance. What model.conditions says stands for
/// the campaign; without it temperatures that effects name are assumed at 20 degC, time and feed at 0, until
/// they are stated.
FitResult stated_result(const Machine& machine, const ModelSpec& model);

/// Whether a model states an error: a function with coefficients, a known location, an effect, the error of a
/// tool's offset.
bool states_errors(const ModelSpec& model);

/// Those that count as nothing where no fit follows.
std::vector<EffectSpec> effects_without_amplitude(const ModelSpec& model);

/// The effect of that kind in the model, made without values where it has none.
EffectSpec& only_effect(const std::string& kind, ModelSpec& model);
/// Where the parameter of an amplitude stands; one that is new is put at the end, as a stated one.
int place_of_amplitude(const EffectAmplitude& amplitude, ParameterLayout& layout);

/// Throws InputError where it states none, and for an effect without an amplitude, which would count as
/// nothing.
void require_stated_errors(const ModelSpec& model);

}  // namespace volcal
