#pragma once
/// Score test of a family of candidate columns: is there more of it in the residuals than noise puts there?
/// LM = s^T G^-1 s with G = g~^T g~ and s = g~^T r~ (Rao 1948); chi-squared with the rank of G under the
/// model.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/criticism/projection/projector.h"

namespace volcal {

struct ScoreTest {
  double lm = 0.0;
  int dof = 0;  ///< visible directions; 0 = nothing of the family is visible
  double log10_p = 0.0;
  double visible_fraction = 0.0;  ///< |g~| / |g_w|, over the columns in root mean square
  Eigen::VectorXd amplitude;      ///< SI, least norm where a direction is invisible
  Eigen::MatrixXd covariance;     ///< of `amplitude`

  /// LM of some of the amplitudes alone, the others being zero. As many as `which` has elements.
  double lm_of(const std::vector<Eigen::Index>& which) const;

  Eigen::MatrixXd gram;   ///< g~^T g~
  Eigen::VectorXd score;  ///< g~^T r~
};

/// `largest`: of each |amplitude| that can be believed, SI; empty: any. A column that moves the readings by
/// less than their noise even then is rounding, as the sine of a period is at its nodes, and is not visible.
ScoreTest score_test(const ProjectedColumns& projected, Eigen::Index first, Eigen::Index columns,
                     const Eigen::VectorXd& largest = {});

/// The columns as a variance component, independent amplitudes of one variance (Lin 1997, Biometrika 84,
/// 309): |s|^2 follows a sum of chi-squared variables weighted by the eigenvalues of G.
struct KernelTest {
  double lm = 0.0;  ///< |s|^2 scaled to `dof` degrees of freedom
  double dof = 0.0;
  double log10_p = 0.0;
};
KernelTest kernel_test(const ProjectedColumns& projected, Eigen::Index first, Eigen::Index columns);

}  // namespace volcal
