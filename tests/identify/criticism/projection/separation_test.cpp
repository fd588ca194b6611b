// Hand-worked angles between hypotheses.

#include "volcal/identify/criticism/projection/separation.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "volcal/model/description/units.h"

namespace volcal {
namespace {

/// Columns of length 3 and 5 at an angle.
Eigen::MatrixXd two_columns(double angle) {
  Eigen::MatrixXd gram(2, 2);
  gram << 9.0, 15.0 * std::cos(angle), 15.0 * std::cos(angle), 25.0;
  return gram;
}

TEST(Separation, TwoColumnsAtAKnownAngle) {
  const Eigen::MatrixXd gram = two_columns(30.0 * kRadianPerDegree);
  EXPECT_NEAR(canonical_cosine(gram, {0, 1}, {1, 1}), std::cos(30.0 * kRadianPerDegree), 1e-14);
  // 9 sin^2 30 = 9 / 4.
  EXPECT_NEAR(projected_off(gram, {0, 1}, {1, 1})(0, 0), 2.25, 1e-14);
  const Eigen::VectorXd reference = Eigen::VectorXd::Constant(1, 9.0);
  const double alone = amplitude_uncertainty(gram.topLeftCorner(1, 1), reference)[0];
  const double beside = amplitude_uncertainty(projected_off(gram, {0, 1}, {1, 1}), reference)[0];
  EXPECT_NEAR(alone, 1.0 / 3.0, 1e-15);
  EXPECT_NEAR(beside / alone, 1.0 / std::sin(30.0 * kRadianPerDegree), 1e-12);  // MIB = MDB / sin
}

TEST(Separation, TheSamePredictionIsNeverToldApart) {
  const Eigen::MatrixXd gram = two_columns(0.0);
  const Eigen::VectorXd reference = Eigen::VectorXd::Constant(1, 9.0);
  EXPECT_TRUE(std::isinf(amplitude_uncertainty(projected_off(gram, {0, 1}, {1, 1}), reference)[0]));
  EXPECT_NEAR(canonical_cosine(gram, {0, 1}, {1, 1}), 1.0, 1e-15);
}

/// Against least squares with the rival's columns in the model.
TEST(Separation, SubspacesAgreeWithLeastSquares) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd columns = Eigen::MatrixXd::NullaryExpr(40, 5, [&] { return normal(generator); });
  const Eigen::MatrixXd gram = columns.transpose() * columns;
  const Eigen::MatrixXd covariance = gram.inverse();
  const Eigen::VectorXd u =
      amplitude_uncertainty(projected_off(gram, {0, 2}, {2, 3}), gram.diagonal().head(2));
  EXPECT_NEAR(u[0], std::sqrt(covariance(0, 0)), 1e-12);
  EXPECT_NEAR(u[1], std::sqrt(covariance(1, 1)), 1e-12);

  const Eigen::MatrixXd a =
      columns.leftCols(2).householderQr().householderQ() * Eigen::MatrixXd::Identity(40, 2);
  const Eigen::MatrixXd b =
      columns.rightCols(3).householderQr().householderQ() * Eigen::MatrixXd::Identity(40, 3);
  const Eigen::MatrixXd product = a.transpose() * b * b.transpose() * a;
  const double squared = product.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff();
  EXPECT_NEAR(canonical_cosine(gram, {0, 2}, {2, 3}), std::sqrt(squared), 1e-12);
}

TEST(Separation, ProjectionOffGivenColumnsKeepsPlaces) {
  const Eigen::MatrixXd left = projected_off(two_columns(60.0 * kRadianPerDegree), ColumnRange{1, 1});
  EXPECT_NEAR(left(0, 0), 9.0 * 0.75, 1e-14);
  EXPECT_EQ(left(1, 1), 0.0);
  EXPECT_EQ(left(0, 1), 0.0);
  EXPECT_TRUE(projected_off(two_columns(1e-6), ColumnRange{1, 1}).isZero(0.0));  // rounding is cleared
}

/// Columns (1, 0) and (0, 1) against a rival along (1, 0): what is nearest to it lies along (1, 0).
TEST(Separation, TheLeastSeparatedAmplitudeLiesAlongTheRival) {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Identity(3, 3);
  gram(0, 2) = gram(2, 0) = 0.9;
  const Eigen::VectorXd amplitude = least_separated_amplitude(
      gram.topLeftCorner(2, 2), projected_off(gram, {0, 2}, {2, 1}), Eigen::VectorXd::Ones(2), 16.0);
  EXPECT_NEAR(std::abs(amplitude[0]), 4.0, 1e-12);
  EXPECT_NEAR(amplitude[1], 0.0, 1e-12);
}

TEST(Separation, WithoutVisibleDirectionTheKnownNormSetsTheSize) {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Constant(1, 1, 1e-12);
  clear_invisible(Eigen::VectorXd::Constant(1, 2.0), gram);
  EXPECT_EQ(gram(0, 0), 0.0);
  EXPECT_TRUE(std::isnan(canonical_cosine(gram, {0, 1}, {0, 1})));
  EXPECT_NEAR(least_separated_amplitude(gram, gram, Eigen::VectorXd::Constant(1, 2.0), 9.0)[0], 1.5, 1e-15);
}

}  // namespace
}  // namespace volcal
