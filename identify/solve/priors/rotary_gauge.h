#pragma once
/// Conventions between the error motions of a rotary axis and the body that it carries. A part of two
/// transverse motions that turns with the axis, Rot(q) eta, moves what the axis carries as a constant error
/// of that body does: the location of the next rotary axis, the offset of an uncertain tool, or the place of
/// the workpiece. No reading tells the two apart. It belongs to the body carried; the error motions keep what
/// is orthogonal to it in their coefficients: over the travel, uniformly weighted, for Fourier series of a
/// full turn; for splines of a part of a turn a convention that depends on their knots.
///
/// Found from the columns of the model at poses spread over the travel, for any structure: combinations of
/// the errors that no pose shows are made zero in the error motions.

#include "volcal/identify/solve/normals/datum.h"
#include "volcal/identify/solve/normals/minimise.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {

/// Precision that holds the conventions, reduced coordinates; no rows where no rotary axis has functions.
Eigen::MatrixXd rotary_gauge(const MeasurementModel& model, const DatumSpace& datum);

}  // namespace volcal
