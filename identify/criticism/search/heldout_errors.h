#pragma once
/// How far the prediction of held-out readings may be off by noise alone.
///
/// Readings y_h = J_h x + e_h are predicted with the x that the others give. With Sigma the noise model, A
/// the information about x (priors included), f the readings in use,
///
///   d = y_h - J_h x^ ,   Cov d = Sigma_hh + J_h A^-1 J_h^T - J_h A^-1 B^T - B A^-1 J_h^T,
///   B = Sigma_hf Sigma_ff^-1 J_f
///
/// (Searle, Casella and McCulloch 2006, Variance Components, 7.4: error of prediction). B is what correlated
/// drift and line offsets share: a dead path takes up the correlated drift of its setup, and held-out
/// readings have that correlated drift too. Without B correlated drift is counted twice, and what an effect
/// moves disappears in it.

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "volcal/identify/criticism/projection/projector.h"
#include "volcal/identify/noise/noise_model.h"

namespace volcal {

/// Held-out readings of a sequence, which depend on each other; those of others hardly do.
struct HeldoutBlock {
  std::vector<Eigen::Index> observation;
  Eigen::MatrixXd covariance;  ///< of their errors of prediction
};

/// Derivatives of observations to all parameters of the projector, accepted columns last.
using RowsOf = std::function<Eigen::MatrixXd(const std::vector<Eigen::Index>& observations)>;
/// A column of the same for all observations.
using ColumnOf = std::function<Eigen::VectorXd(Eigen::Index parameter)>;

/// `data`: of all readings; `heldout`: those that `projector` does not use. One block per sequence that has
/// some; missing observations are in none.
std::vector<HeldoutBlock> heldout_errors(const NoiseData& data, const std::vector<bool>& heldout,
                                         std::span<const NoiseParameters> noise, const Projector& projector,
                                         const RowsOf& rows_of, const ColumnOf& column_of, int threads);

/// What the held-out readings say of the residuals, given their covariance.
struct HeldoutFigures {
  double count = 0.0;
  double squares = 0.0;   ///< sum
  double expected = 0.0;  ///< of that sum, from noise alone
  double spread = 0.0;    ///< its standard deviation
  double log_likelihood = 0.0;
};
HeldoutFigures heldout_figures(const std::vector<HeldoutBlock>& blocks, const Eigen::VectorXd& residual);

}  // namespace volcal
