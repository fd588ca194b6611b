#pragma once
/// Smoothing priors of functions with `knots = "auto"`, and variance components, both by evidence.
///
/// A function f with a smoothing prior has prior precision lambda S, S = L^(2k-1) x Gram matrix of the k-th
/// derivatives over the travel L (k = 2 for cubic and quadratic splines): lambda in 1/m^2 or 1/rad^2. lambda
/// and the variance components s_g^2 (sigma of instrument g is s_g times stated) maximise the marginal
/// likelihood by MacKay's fixed point (MacKay 1992, Neural Computation 4, 415; for s_g Foerstner 1979,
/// Helmert's iteration):
///   lambda_f <- (rank S_f - lambda_f tr(C S_f)) / (z_f^T S_f z_f),   s_g^2 <- v_g^T W_g v_g / (n_g - tr(C
///   M_g) / s_g^2).
/// The posterior covariance C then contains the truncation of the basis (Nychka 1988, JASA 83, 1134: such
/// intervals cover the truth at the stated rate on average over the positions).

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/solve/minimise.h"

namespace volcal {

struct SmoothingTerm {
  ErrorSymbol symbol;
  int offset = 0;           ///< in the reduced vector
  Eigen::MatrixXd penalty;  ///< S, reduced
  double rank = 0.0;
  double lambda = 0.0;   ///< 1/m^2 or 1/rad^2
  bool estimate = true;  ///< false: held (nothing in the data speaks about it)
};

/// Terms for the functions that are smoothed, lambda set to a weak start.
std::vector<SmoothingTerm> smoothing_terms(const MeasurementModel& model, const DatumSpace& datum);
void add_smoothing(const std::vector<SmoothingTerm>& terms, GaussianPrior& prior);

/// Quadratic model of one instrument's readings about z0: M, J^T W (predicted - reading), weighted squares.
struct InstrumentEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
  double squares = 0.0;
  double observations = 0.0;
};

struct EvidenceOptions {
  bool variance_components = true;
  int max_iterations = 80;
  double tolerance = 0.02;  ///< on the change of log lambda of effective terms
};

struct EvidenceState {
  std::vector<double> scale;       ///< s_g per instrument
  std::vector<double> redundancy;  ///< per instrument
  int iterations = 0;
};

/// Updates `terms` and the instrument scales. `equations` hold stated weights, `prior` everything but
/// smoothing.
EvidenceState maximise_evidence(const std::vector<InstrumentEquations>& equations, const Eigen::VectorXd& z0,
                                const GaussianPrior& prior, const EvidenceOptions& options,
                                std::vector<double> scale, std::vector<SmoothingTerm>& terms);

}  // namespace volcal
