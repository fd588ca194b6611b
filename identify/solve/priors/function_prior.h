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
///
/// Of an axis that was measured on a part of its travel, t runs from -1 to 1 over that part. Stationary
/// covariances go on outside; Legendre series continue from value and slope at the edge as a squared
/// exponential covariance of a fixed length would: with the same variance, and ever less bound to the part.
/// A distance d outside counts as h log(1 + d / h), h = 1/4 in t, since the pieces of the basis double in
/// length there: what they did not resolve would be averaged away, and the uncertainty would fall with the
/// distance.
///
/// A Fourier series on an axis that turns fully has a periodic prior: constant parts are free, cosine and
/// sine of harmonic k have the variance e^(-2 k l) (geometric), e^(-2 (k l)^2) (heat), e^(-(2 pi k l)^2 / 2)
/// (squared exponential) or (1 + (2 pi k l)^2 / 5)^-3 (Matern 5/2), l a share of the turn in the last two.
///
/// The spectrum of the chosen one, the variance of each Legendre coefficient, is then corrected degree by
/// degree by the functions that share it, and the corrected one is taken where its evidence is higher
/// (smoothing.h).

#include <Eigen/Core>
#include <memory>
#include <string_view>
#include <vector>

#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/functions/basis.h"

namespace volcal {

enum class Roughness { Geometric, Heat, SquaredExponential, Matern52 };
inline constexpr int kRoughnessKinds = 4;
inline constexpr int kPriorLengths = 12;  ///< per kind, ascending

std::string_view to_string(Roughness roughness);

struct PriorShape {
  Roughness roughness = Roughness::Geometric;
  /// Share of the stretch: correlation length, or 1 / degree at which Legendre coefficients have fallen by e.
  double length = 0.0;
  /// Variances of the coefficients of sqrt(2n + 1) P_n, n = 2, 3, ..., of unit amplitude.
  Eigen::VectorXd spectrum;
  Eigen::MatrixXd precision;     ///< of unit amplitude, reduced coordinates, singular for the straight part
  double log_determinant = 0.0;  ///< of its regular part, up to a constant common to all shapes of a function
  int rank = 0;
  bool periodic = false;  ///< the spectrum is of cos q, sin q, cos 2q, sin 2q, ...

  /// Standard deviation of the deviation from a straight line over that of its slope, weighted by 1 - t^2, a
  /// share of the stretch: about the length of a squared exponential covariance, less where that is long. Of
  /// a periodic one, standard deviation over that of the slope, a share of the turn.
  double correlation_length() const;
};

/// The priors that a function may have, for one basis and datum.
class FunctionPriors {
 public:
  FunctionPriors(const Basis& basis, const Axis& axis, const Eigen::MatrixXd& datum_basis);
  FunctionPriors(const Basis& basis, const ResolvedStretch& stretch, const Eigen::MatrixXd& datum_basis);

  /// Of the stretch that the lengths are shares of, m or rad.
  double stretch_length() const { return stretch_length_; }

  /// What evidence chooses from: kind by kind, lengths ascending, lengths with the same index being about as
  /// smooth. Empty when the basis holds straight lines only.
  const std::vector<std::shared_ptr<const PriorShape>>& shapes() const { return shapes_; }

  /// Independent Legendre coefficients with these variances up to a common factor.
  PriorShape with_spectrum(const PriorShape& like, const Eigen::VectorXd& variances) const;

  /// Expected squares of a function's Legendre coefficients, in units of 1 / lambda, given its posterior in
  /// reduced coordinates under independent coefficients with the spectrum of `prior`.
  Eigen::VectorXd expected_squares(const PriorShape& prior, double lambda, const Eigen::VectorXd& mean,
                                   const Eigen::Ref<const Eigen::MatrixXd>& covariance) const;

 private:
  void add_periodic_shapes(const Basis& basis, const Eigen::MatrixXd& datum_basis);
  /// Precision, determinant and rank alone.
  PriorShape with_covariance(const Eigen::MatrixXd& of_contrasts) const;
  Eigen::MatrixXd with_nugget(Eigen::MatrixXd of_contrasts) const;

  double stretch_length_ = 0.0;
  bool periodic_ = false;
  bool reaches_beyond_ = false;  ///< the basis, beyond the stretch
  Eigen::MatrixXd of_reduced_;   ///< contrasts (combinations that vanish for straight lines) x reduced
  Eigen::MatrixXd of_series_;    ///< contrasts x Legendre degrees or Fourier terms
  Eigen::MatrixXd of_outside_;   ///< covariance of contrasts by what is free outside the stretch; or empty
  std::vector<std::shared_ptr<const PriorShape>> shapes_;
};

}  // namespace volcal
