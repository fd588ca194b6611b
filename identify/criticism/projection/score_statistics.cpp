#include "volcal/identify/criticism/projection/score_statistics.h"

#include <algorithm>
#include <cmath>

#include "volcal/identify/criticism/data/thresholds.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/statistics/chi_squared.h"
#include "volcal/identify/statistics/quadratic_form.h"

namespace volcal {
namespace {

constexpr double kWorthExactTail = -2.0;  // log10 p: above, two moments do

}  // namespace

ScoreTest score_test(const ProjectedColumns& projected, Eigen::Index first, Eigen::Index columns,
                     const Eigen::VectorXd& largest) {
  ScoreTest test;
  test.amplitude = Eigen::VectorXd::Zero(columns);
  test.covariance = Eigen::MatrixXd::Zero(columns, columns);
  Eigen::VectorXd norm = projected.norm.segment(first, columns);
  if (largest.size() > 0) norm = (norm.cwiseProduct(largest).array() < 1.0).select(0.0, norm);
  if (norm.maxCoeff() == 0.0) return test;
  const Eigen::VectorXd scale =
      norm.unaryExpr([](double length) { return length > 0.0 ? 1.0 / length : 0.0; });
  test.gram = projected.gram(first, columns);
  test.score = projected.score.segment(first, columns);
  const Eigen::MatrixXd gram = scale.asDiagonal() * test.gram * scale.asDiagonal();
  const Eigen::VectorXd score = scale.cwiseProduct(test.score);
  const SymmetricEigen eigen = eigen_decomposition(gram);
  test.visible_fraction = std::sqrt(std::max(0.0, gram.trace() / static_cast<double>(columns)));
  for (Eigen::Index k = 0; k < columns; ++k) {
    const double value = eigen.values[k];
    if (value < kThresholds.invisible_share * kThresholds.invisible_share) continue;
    const Eigen::VectorXd direction = eigen.vectors.col(k);
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

double ScoreTest::lm_of(const std::vector<Eigen::Index>& which) const {
  const Eigen::VectorXd own = score(which);
  Eigen::MatrixXd own_gram = gram(which, which);
  const Eigen::VectorXd scale = own_gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  own_gram = scale.asDiagonal() * own_gram * scale.asDiagonal();
  const Eigen::VectorXd scaled = scale.cwiseProduct(own);
  return scaled.dot(least_squares(own_gram, scaled, kThresholds.invisible_share).solution);
}

KernelTest kernel_test(const ProjectedColumns& projected, Eigen::Index first, Eigen::Index columns) {
  const Eigen::MatrixXd gram = projected.gram(first, columns);
  const double trace = gram.trace(), squares = gram.squaredNorm();
  const double score = projected.score.segment(first, columns).squaredNorm();
  const double floor = kThresholds.invisible_share * projected.norm.segment(first, columns).squaredNorm();
  if (!(trace > floor)) return {};
  KernelTest test{score * trace / squares, trace * trace / squares, 0.0};
  test.log10_p = log10_chi_squared_exceedance(test.lm, test.dof);
  if (test.log10_p < kWorthExactTail) {
    test.log10_p = log10_quadratic_form_exceedance(score, eigenvalues(gram).cwiseMax(0.0));
  }
  return test;
}

}  // namespace volcal
