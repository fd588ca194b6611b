#pragma once
/// Which errors of a machine are unknown, by its axes, its datum and what the model file says: the one place
/// that decides it.

#include <map>
#include <vector>

#include "volcal/model/description/campaign.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/description/symbols.h"

namespace volcal {

/// The six error motions of every linear axis, of X first.
std::vector<ErrorSymbol> linear_axis_motions(const Machine& machine);
/// Squareness errors of the datum whose axes the machine has, then the two angles of each of U, V, W: its
/// direction against that of the frame, EA0W and EB0W of W. Its parallelism to Z is the difference from the
/// angles of Z.
std::vector<LocationSymbol> squareness_errors(const Machine& machine);
/// Location errors that the machine can have: squareness_errors(), and of each rotary axis all but the
/// displacement along it.
std::vector<LocationSymbol> possible_locations(const Machine& machine);

/// Rotary axes that the readings move by more than a thousandth of their travel; readings that are left out
/// do not count.
std::vector<AxisName> moving_rotary_axes(const Campaign& campaign);
/// Where the other rotary axes stood, rad.
std::map<AxisName, double> standing_rotary_axes(const Campaign& campaign);
/// Rotary axes that the readings move and of which the model has neither an error motion nor a location.
std::vector<AxisName> rotary_axes_without_errors(const Campaign& campaign, const ModelSpec& model);
/// linear_axis_motions(), and the six error motions of every rotary axis that moves.
std::vector<ErrorSymbol> motions_in_campaign(const Campaign& campaign);
/// A full turn, or nearly: its functions are periodic.
bool turns_fully(const Axis& axis);
/// What an error motion of an axis is unless the model says otherwise: a spline, of a rotary axis that turns
/// fully a Fourier series; both as fine as the readings allow.
FunctionSpec usual_function(const Axis& axis);
/// The model with the six error motions and the `locations` of every rotary axis in `moving` that it does not
/// name: Fourier series where the axis turns fully, splines where it does not. Nothing is added to a model
/// whose default is that there are no functions.
ModelSpec with_rotary_errors(const Machine& machine, ModelSpec model, const std::vector<AxisName>& moving,
                             const std::vector<LocationSymbol>& locations);

/// The model without what it says of what the machine file calls uncertain, offsets of the campaign's tools
/// and expansions of scales: readings of a fit tell that, from the stated value on.
ModelSpec with_uncertain_values_open(const Campaign& campaign, ModelSpec model);

/// Error motions with a function: of a linear axis all, of a rotary one those that the model names. The
/// function may be the basis "zero", which has no parameters.
std::vector<ErrorSymbol> modelled_motions(const Machine& machine, const ModelSpec& model);
/// Location errors with a parameter: squareness_errors() that are not left out, and of rotary axes what the
/// model names.
std::vector<LocationSymbol> modelled_locations(const Machine& machine, const ModelSpec& model);

}  // namespace volcal
