#pragma once
/// Gaussian-process priors for error functions with `knots = "auto"`: how an error function may look before
/// any reading is seen. Constant and straight parts are free; the prior is on the deviation from them
/// (intrinsic, flat on its null space). Its covariance between two positions a, b of the travel, t in [-1,
/// 1], is one of
///   geometric   sum_n (2n + 1) e^(-2 n l)      P_n(t_a) P_n(t_b)   Legendre coefficients fall geometrically,
///               as those of every analytic function do (Davis 1963, Interpolation and Approximation, 12.4);
///   heat        sum_n (2n + 1) e^(-2 (n l)^2)  P_n(t_a) P_n(t_b)   smoother still, the heat kernel of
///               Legendre's operator up to the linear term;
///   squared exponential, Matern 5/2   stationary, of |a - b| / l (Rasmussen and Williams 2006,
///   eq. 4.9, 4.17),
/// scaled to a mean variance of 1 over the travel, projected on the basis by least squares and expressed in
/// the coordinates of the datum (Z of datum.h).

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "volcal/model/description/machine.h"
#include "volcal/model/functions/basis.h"

namespace volcal {

enum class Roughness { Geometric, Heat, SquaredExponential, Matern52 };
inline constexpr int kRoughnessKinds = 4;
inline constexpr int kPriorLengths = 12;  ///< per kind, ascending

std::string_view to_string(Roughness roughness);

struct PriorShape {
  Roughness roughness = Roughness::Geometric;
  /// Share of the travel: correlation length, or 1 / degree at which Legendre coefficients have fallen by e.
  double length = 0.0;
  Eigen::MatrixXd precision;     ///< of unit amplitude, reduced coordinates, singular for the straight part
  double log_determinant = 0.0;  ///< of its regular part, up to a constant common to all shapes of a function
  int rank = 0;
};

/// All shapes that evidence chooses from, for one basis and datum: kind by kind, lengths ascending, lengths
/// with the same index being about as smooth. Empty when the basis holds straight lines only.
std::vector<PriorShape> prior_shapes(const Basis& basis, const Axis& axis,
                                     const Eigen::MatrixXd& datum_basis);

}  // namespace volcal
