#pragma once
/// How far two hypotheses are apart once the model has been allowed to imitate both: from the Gram matrix
/// G = g~^T g~ of their columns after projection (projector.h).
///
/// With a second projection, off the rival's columns, G_f|r = G_ff - G_fr G_rr^+ G_rf. Amplitudes a of f then
/// stand a^T G_f|r a apart from anything that the rival could predict, in units of the noise variance: the
/// quantity of T-optimal designs (Atkinson and Fedorov 1975, Biometrika 62, 57). For one column each it is
/// a^2 |g~_f|^2 sin^2 of the angle between them.

#include <Eigen/Core>
#include <vector>

namespace volcal {

/// Columns of one hypothesis in a Gram matrix.
struct ColumnRange {
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};

/// Sets to 0 what is left of columns of which nothing is visible but rounding; `known_norm` = |L^-1 g|,
/// before the projection off the model. The functions below ask for a matrix that went through this.
void clear_invisible(const Eigen::VectorXd& known_norm, Eigen::MatrixXd& gram);

/// Components of all columns along an orthonormal basis of the visible directions of one hypothesis: rank x
/// columns of `gram`.
Eigen::MatrixXd components_along(const Eigen::MatrixXd& gram, ColumnRange hypothesis);
/// Gram matrix after projection off further columns of the same matrix; all columns keep their places, the
/// given ones and those of which only rounding is left become 0.
Eigen::MatrixXd projected_off(const Eigen::MatrixXd& gram, ColumnRange given);
/// G_f|r alone.
Eigen::MatrixXd projected_off(const Eigen::MatrixXd& gram, ColumnRange wanted, ColumnRange rival);

/// Cosine of the smallest angle between the subspaces (largest canonical correlation, Hotelling 1936), 0..1;
/// NaN when nothing of one of them is visible.
double canonical_cosine(const Eigen::MatrixXd& gram, ColumnRange a, ColumnRange b);

/// Standard uncertainties of amplitudes with the Gram matrix `gram`; infinite where an amplitude is not
/// determined: along directions with less than Thresholds::same_squared_sine of what `reference`, the Gram
/// matrix before the last projection, has on its diagonal.
Eigen::VectorXd amplitude_uncertainty(const Eigen::MatrixXd& gram, const Eigen::VectorXd& reference);

/// Amplitudes that are found with the noncentrality `noncentrality` but are, of all those, the least apart
/// from the rival. Where nothing is visible: sizes that would be found if all else were known, from
/// `known_norm` = |L^-1 g|.
Eigen::VectorXd least_separated_amplitude(const Eigen::MatrixXd& own, const Eigen::MatrixXd& apart,
                                          const Eigen::VectorXd& known_norm, double noncentrality);

}  // namespace volcal
