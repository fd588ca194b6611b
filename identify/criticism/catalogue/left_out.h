#pragma once
/// Errors that the model holds at zero, as hypotheses: a function with basis "zero" (a model of positioning
/// and straightness alone leaves nine out), a squareness switched off. What a diagnosis names of them is no
/// effect to add but a change of the model; its EffectSpec has the kind kLeftOut and the symbols.

#include <memory>
#include <string>
#include <vector>

#include "volcal/model/effects/effect.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

inline constexpr const char* kLeftOut = "left-out";
inline constexpr const char* kLeftOutSummary =
    "an error function or squareness that the model file switches off: give it back to the model";

struct LeftOutError {
  EffectSpec spec;
  std::unique_ptr<Effect> effect;  ///< polynomials of the axis' own position; amplitudes m or rad
};

/// One for every error motion of a linear axis and every squareness that the model lacks, and one for all
/// lacking rotations together when there are several.
std::vector<LeftOutError> left_out_errors(const MeasurementModel& model);

/// Gives what `spec` names back to the model; false when it is an effect of the catalogue.
bool restore_left_out(const EffectSpec& spec, ModelSpec& model);
/// The symbols that `spec` names: "EAX", "EC0Y".
std::vector<std::string> left_out_symbols(const EffectSpec& spec);

}  // namespace volcal
