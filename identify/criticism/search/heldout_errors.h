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
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "volcal/identify/criticism/projection/projector.h"
#include "volcal/identify/noise/noise_model.h"

namespace volcal {

/// Held-out readings of a sequence, which depend on each other; those of others hardly do.
struct HeldoutBlock {
  std::vector<Eigen::Index> observation;
  /// L of the covariance L L^T of their errors of prediction; of its diagonal, where rounding leaves it
  /// indefinite, as for parameters that nothing determines.
  Eigen::MatrixXd lower;
  bool is_definite = true;
  double expected = 0.0;  ///< trace of the covariance
  double squares = 0.0;   ///< sum of the squares of its elements
};

/// Derivatives of observations to all parameters of the projector, accepted columns last.
using RowsOf = std::function<Eigen::MatrixXd(const std::vector<Eigen::Index>& observations)>;
/// A column of the same for all observations.
using ColumnOf = std::function<Eigen::VectorXd(Eigen::Index parameter)>;

/// What the held-out readings say of the residuals, given their covariance.
struct HeldoutFigures {
  double count = 0.0;
  double squares = 0.0;   ///< sum
  double expected = 0.0;  ///< of that sum, from noise alone
  double spread = 0.0;    ///< its standard deviation
  double log_likelihood = 0.0;
};

/// One block per sequence that has held-out readings; missing observations are in none. With further columns
/// c in the model, of which A becomes [A a; a^T b],
///
///   Cov' = Cov + (k - l) S^-1 (k - l)^T - l S^-1 l^T,   S = b - a^T A^-1 a,
///
/// k and l what J and B have in the columns c, less what they have in A^-1 a: of all that takes time, B of
/// the model's own columns, its products and the factor of Cov, nothing is made again (Searle, Casella and
/// McCulloch 2006, appendix M.5: determinant and inverse of a sum). Immutable. Memory: 8 bytes x held-out
/// readings x (parameters + held-out readings of a sequence), and some hundred bytes a reading.
class HeldoutErrors {
 public:
  /// `data`: of all readings; `heldout`: those that `projector` does not use.
  HeldoutErrors(const NoiseData& data, const std::vector<bool>& heldout,
                std::span<const NoiseParameters> noise, const Projector& projector, const RowsOf& rows_of,
                const ColumnOf& column_of, int threads);

  const std::vector<HeldoutBlock>& blocks() const { return blocks_; }

  /// Columns that a projector has accepted last, of all observations.
  struct Accepted {
    Eigen::MatrixXd columns;
    Eigen::MatrixXd directions;  ///< Projector::last_directions()
    Eigen::MatrixXd moved;       ///< [J columns] directions
  };
  /// Figures of the residuals with them in the model; equal to rounding. Nothing where the covariances, with
  /// them or without, are not definite.
  std::optional<HeldoutFigures> figures_accepting(const Accepted& accepted, const Eigen::VectorXd& residual,
                                                  int threads) const;

 private:
  struct Sequence;
  struct Fixed;
  using Rows = std::vector<Eigen::MatrixXd>;  ///< of every block
  static Rows shared_rows(const Fixed& fixed, const ColumnOf& column_of, Eigen::Index columns, int threads);

  std::shared_ptr<const Fixed> fixed_;
  Rows shared_rows_;  ///< B
  std::vector<HeldoutBlock> blocks_;
};

HeldoutFigures heldout_figures(const std::vector<HeldoutBlock>& blocks, const Eigen::VectorXd& residual);

}  // namespace volcal
