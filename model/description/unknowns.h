#pragma once
/// Which errors of a machine are unknown, by its axes, its datum and what the model file says: the one place
/// that decides it.

#include <vector>

#include "volcal/model/description/machine.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/description/symbols.h"

namespace volcal {

/// X, Y, Z, of which the machine has them.
std::vector<AxisName> linear_axes(const Machine& machine);
/// The six error motions of every linear axis, of X first.
std::vector<ErrorSymbol> linear_axis_motions(const Machine& machine);
/// Squareness errors of the datum whose axes the machine has.
std::vector<LocationSymbol> squareness_errors(const Machine& machine);
/// Location errors that the machine can have: squareness, and of each rotary axis all but the displacement
/// along it.
std::vector<LocationSymbol> possible_locations(const Machine& machine);

/// Error motions with a function: of a linear axis all, of a rotary one those that the model names. The
/// function may be the basis "zero", which has no parameters.
std::vector<ErrorSymbol> modelled_motions(const Machine& machine, const ModelSpec& model);
/// Location errors with a parameter: squareness that is not left out, and of rotary axes what the model
/// names.
std::vector<LocationSymbol> modelled_locations(const Machine& machine, const ModelSpec& model);

}  // namespace volcal
