#pragma once
/// Resolution of functions with `knots = "auto"`, and variance components, both by evidence.
///
/// The knots are as fine as the readings can separate (resolution.h); a Gaussian-process prior per function
/// (function_prior.h) says how rough it may be. Its kind and length; its amplitude, one per function; and the
/// variance components s_g^2 (sigma of instrument g is s_g times stated) maximise the marginal likelihood of
/// all readings together (restricted likelihood: nuisance parameters and straight parts integrated out).
/// Amplitudes follow MacKay's fixed point, lambda <- (rank - lambda tr(C S)) / z^T S z (MacKay 1992, Neural
/// Computation 4, 415); variance components Foerstner's (1979), s_g^2 <- v_g^T W_g v_g / (n_g - tr(C M_g) /
/// s_g^2).
///
/// Kind and length (a share of the travel) are those of an axis, whose functions ride on one guideway, and of
/// all linear axes together but for those that very strong evidence sets apart. Six functions tell a length
/// from the next one by a few units of log likelihood or less, so that axes left to themselves stray, and a
/// prior that is too smooth costs more than one that is too rough.
///
/// Then the variances of Legendre's coefficients are corrected degree by degree, by expectation and
/// maximisation with conjugate priors (scaled inverse chi-squared; Gelman et al. 2013, Bayesian Data
/// Analysis, 2.6): those common to the linear axes about the shape's, those of an axis about the common ones.
/// The correction takes the coefficients as independent, which those of stationary shapes are not; it holds
/// where the evidence is higher with it.
///
/// A surface chooses its lengths for itself, by the same evidence.
///
/// Where the readings settle less than a coefficient of a function, the evidence of its amplitude is often
/// highest at none at all, and its intervals would be those of a function known to be straight. There the
/// amplitude is the one at which evidence and a prior in proportion to it, a exp(-a / 5 um), are highest
/// together: about a standard error from none, and 5 um where readings say nothing (Chung et al. 2013,
/// Psychometrika 78, 685).
///
/// The posterior covariance C then contains the truncation of the basis (Nychka 1988, JASA 83, 1134: such
/// intervals cover the truth at the stated rate on average over the positions).

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/solve/priors/smoothing.h"

namespace volcal {

/// Quadratic model of one noise group's readings about z0: M, J^T W (predicted - reading), weighted squares.
struct NoiseGroupEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
  double squares = 0.0;
  double observations = 0.0;
};

struct EvidenceOptions {
  bool variance_components = true;
  int threads = 1;  ///< results do not depend on it
};

struct EvidenceState {
  std::vector<double> scale;  ///< s_g per instrument
  double log_evidence = 0.0;  ///< up to a constant
};

/// Updates `terms` and the instrument scales. `equations` hold stated weights, `prior` everything but
/// smoothing.
EvidenceState maximise_evidence(const std::vector<NoiseGroupEquations>& equations, const Eigen::VectorXd& z0,
                                const GaussianPrior& prior, const EvidenceOptions& options,
                                std::vector<double> scale, std::vector<SmoothingTerm>& terms);

}  // namespace volcal
