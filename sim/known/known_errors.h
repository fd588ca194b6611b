#pragma once
/// Errors that are known, as a model file states them, in place of random ones. Functions, locations and
/// effects are evaluated here, by code that shares nothing with model/: splines by de Boor's algorithm,
/// Legendre series by their recurrence, effects by the formulas of their kinds in exact transforms.

#include <map>
#include <string>
#include <vector>

#include "volcal/model/description/model_spec.h"
#include "volcal/sim/hidden/hidden_effects.h"
#include "volcal/sim/machine/truth_machine.h"

namespace volcal::sim {

/// Functions with coefficients, in place of others; `file` names them in messages. Beyond the breakpoints the
/// end pieces are continued. Throws InputError for a basis that is not simulated.
void set_known_functions(const std::map<ErrorSymbol, FunctionSpec>& functions, const std::string& file,
                         TruthMachine& truth);

/// Functions with coefficients and known locations; what has no value is zero. Throws as above.
void set_known_errors(const ModelSpec& errors, TruthMachine& truth);

/// The effects with their amplitudes. Throws InputError, at the effect's place, for a kind that is not
/// simulated, and for an axis, tool or temperature that the study does not have.
void add_known_effects(const ModelSpec& errors, const HiddenContext& context, HiddenScene& scene);

/// Kinds of effects of a model that are simulated, in the order of their names.
std::vector<std::string> known_effect_kinds();

}  // namespace volcal::sim
