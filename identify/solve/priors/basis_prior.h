#pragma once
/// What a basis, and nothing else, decides of the priors of its functions.

#include <Eigen/Core>

#include "volcal/model/description/machine.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/functions/basis.h"

namespace volcal {

/// Whether a function is smoothed (function_prior.h): its knots are the program's choice, and its basis has a
/// roughness, or the highest harmonic of its Fourier series is. Fixed knots, Legendre polynomials and Fourier
/// series of a stated degree say themselves how smooth it is.
bool is_smoothed(const FunctionSpec& spec, const Basis& basis);

/// Precision of the coefficients of a function whose standard deviation over the travel is 1, and which is
/// smooth where its basis has a roughness or, of a Fourier series, `smoothed` says so: the wide prior
/// (rank.h) of what the readings do not determine. A harmonic that the program chose beyond those that its
/// readings tell apart is then resolution, as a knot is, and hides no error.
Eigen::MatrixXd wide_precision(const Basis& basis, const Axis& axis, bool smoothed);

}  // namespace volcal
