#pragma once
/// Errors that the model holds at zero, as hypotheses: a function with basis "zero" (a model of positioning
/// and straightness alone leaves nine out), a squareness switched off. What a diagnosis names of them is no
/// effect to add but a change of the model; its EffectSpec has the kind kLeftOut and the symbols.

#include <memory>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/effect_words.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

struct LeftOutError {
  EffectSpec spec;
  std::unique_ptr<Effect> effect;    ///< functions of the axis' own position; amplitudes m or rad
  std::vector<Eigen::Index> orders;  ///< of an error motion: how many amplitudes may stand alone
};

/// One for every error motion and location error that the model lacks, of linear axes and of rotary axes that
/// move: polynomials to the sixth degree, of rotary axes three harmonics.
std::vector<LeftOutError> left_out_errors(const MeasurementModel& model);

/// Writes into the specification of an error motion of a rotary axis in how many harmonics it was found,
/// where that is fewer than were looked for.
void state_order(Eigen::Index order, EffectSpec& spec);

/// Whether the model holds this error motion or location error at zero.
bool is_left_out(const MachineError& error, const ModelSpec& model);

/// Gives what `spec` names, and the model leaves out, back to the model; false when it is an effect of the
/// catalogue.
bool restore_left_out(const EffectSpec& spec, const Machine& machine, ModelSpec& model);

}  // namespace volcal
