#include "volcal/identify/criticism/score_test.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "volcal/identify/stats/chi_squared.h"

namespace volcal {

ScoreTest score_test(const ProjectedColumns& projected, Eigen::Index first, Eigen::Index columns) {
  ScoreTest test;
  test.amplitude = Eigen::VectorXd::Zero(columns);
  test.covariance = Eigen::MatrixXd::Zero(columns, columns);
  const Eigen::VectorXd norm = projected.norm.segment(first, columns);
  if (norm.maxCoeff() == 0.0) return test;
  const Eigen::VectorXd scale =
      norm.unaryExpr([](double length) { return length > 0.0 ? 1.0 / length : 0.0; });
  const Eigen::MatrixXd gram = scale.asDiagonal() * projected.gram(first, columns) * scale.asDiagonal();
  const Eigen::VectorXd score = scale.cwiseProduct(projected.score.segment(first, columns));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
  test.visible_fraction = std::sqrt(std::max(0.0, gram.trace() / static_cast<double>(columns)));
  for (Eigen::Index k = 0; k < columns; ++k) {
    const double value = eigen.eigenvalues()[k];
    if (value < kInvisibleShare * kInvisibleShare) continue;
    const Eigen::VectorXd direction = eigen.eigenvectors().col(k);
    const double along = direction.dot(score);
    test.lm += along * along / value;
    ++test.dof;
    const Eigen::VectorXd scaled = scale.cwiseProduct(direction);
    test.amplitude += scaled * (along / value);
    test.covariance += scaled * scaled.transpose() / value;
  }
  if (test.dof > 0) test.log10_p = log10_chi_squared_exceedance(test.lm, test.dof);
  return test;
}

}  // namespace volcal
