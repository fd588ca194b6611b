/// Dense algebra by LAPACK against hand-worked matrices and what defines each result.

#include "volcal/identify/numeric/dense.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace volcal {
namespace {

constexpr double kDenseRounding = 1e-13;

TEST(Dense, EigenvaluesAscendAndTheirVectorsRebuildTheMatrix) {
  Eigen::MatrixXd a(3, 3);
  a << 2.0, 1.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, -4.0;  // -4, 1 and 3
  const SymmetricEigen eigen = eigen_decomposition(a);
  EXPECT_TRUE(eigen.values.isApprox(Eigen::Vector3d(-4.0, 1.0, 3.0), kDenseRounding));
  EXPECT_TRUE(
      (eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose()).isApprox(a, kDenseRounding));
  EXPECT_TRUE(eigenvalues(a).isApprox(eigen.values, kDenseRounding));
  EXPECT_EQ(eigen_decomposition(Eigen::MatrixXd(0, 0)).values.size(), 0);
}

TEST(Dense, EigenvaluesOfWhatIsNotFiniteAreNotNumbers) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(2, 2);
  a(0, 1) = a(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(eigenvalues(a).array().isNaN().all());
  EXPECT_TRUE(eigen_decomposition(a).vectors.array().isNaN().all());
}

TEST(Dense, UpperFactorOfThreeFourFive) {
  Eigen::MatrixXd a(2, 2);
  a << 3.0, 1.0, 4.0, 2.0;  // lengths 5 and sqrt 5, product 11
  const Eigen::MatrixXd r = upper_factor(a);
  EXPECT_NEAR(std::abs(r(0, 0)), 5.0, kDenseRounding);
  EXPECT_NEAR(r(0, 0) * r(0, 1), 11.0, kDenseRounding);
  EXPECT_EQ(r(1, 0), 0.0);
  EXPECT_NEAR(std::abs(r(1, 1)), 0.4, kDenseRounding);  // sqrt(5 - 2.2^2)
}

TEST(Dense, UpperFactorsAreNoHigherThanTheMatrixIsWide) {
  const Eigen::MatrixXd high = Eigen::MatrixXd::Random(120, 70), wide = Eigen::MatrixXd::Random(70, 120);
  for (const Eigen::MatrixXd& a : {high, wide}) {
    const Eigen::MatrixXd r = upper_factor(a);
    EXPECT_EQ(r.rows(), 70);
    EXPECT_EQ(r.cols(), a.cols());
    EXPECT_TRUE((r.transpose() * r).isApprox(a.transpose() * a, kDenseRounding));
  }
  EXPECT_EQ(upper_factor(Eigen::MatrixXd(3, 0)).rows(), 0);
  EXPECT_EQ(upper_factor(Eigen::MatrixXd(0, 3)).rows(), 0);
}

TEST(Dense, ProductsWithUpperFactorsLeaveOutTheZeros) {
  for (const auto& [rows, columns] : {std::pair(1, 1), {48, 48}, {70, 120}, {100, 49}}) {
    const Eigen::MatrixXd r = upper_factor(Eigen::MatrixXd::Random(rows, columns));
    const Eigen::MatrixXd a = Eigen::MatrixXd::Random(r.rows(), 5);
    Eigen::MatrixXd c = Eigen::MatrixXd::Ones(5, columns);
    add_transposed_product_upper(a, r, c);
    EXPECT_TRUE(c.isApprox(Eigen::MatrixXd::Ones(5, columns) + a.transpose() * r, kDenseRounding))
        << rows << " x " << columns;
  }
}

TEST(Dense, LeastSquaresOfALineThroughThreePoints) {
  Eigen::MatrixXd a(3, 2);
  a << 1.0, 0.0, 1.0, 1.0, 1.0, 2.0;
  const LeastSquares fitted = least_squares(a, Eigen::Vector3d(0.0, 1.0, 5.0));  // -1/2 + 5/2 x
  EXPECT_EQ(fitted.rank, 2);
  EXPECT_TRUE(fitted.solution.isApprox(Eigen::Vector2d(-0.5, 2.5), kDenseRounding));
}

TEST(Dense, LeastSquaresWithoutFullRankHasLeastNorm) {
  Eigen::MatrixXd a(2, 2);
  a << 1.0, 1.0, 2.0, 2.0;
  const LeastSquares fitted = least_squares(a, Eigen::Vector2d(2.0, 4.0));
  EXPECT_EQ(fitted.rank, 1);
  EXPECT_TRUE(fitted.solution.isApprox(Eigen::Vector2d(1.0, 1.0), kDenseRounding));
  const LeastSquares wide = least_squares(Eigen::MatrixXd::Ones(1, 3), Eigen::VectorXd::Constant(1, 3.0));
  EXPECT_TRUE(wide.solution.isApprox(Eigen::Vector3d::Ones(), kDenseRounding));
  EXPECT_EQ(least_squares(Eigen::MatrixXd(0, 2), Eigen::VectorXd(0)).rank, 0);
}

TEST(Dense, LeastSquaresOfWhatIsNotFiniteIsNotANumber) {
  const LeastSquares fitted = least_squares(Eigen::MatrixXd::Ones(2, 1),
                                            Eigen::Vector2d(1.0, std::numeric_limits<double>::infinity()));
  EXPECT_TRUE(fitted.solution.array().isNaN().all());
  EXPECT_EQ(fitted.rank, 0);
}

TEST(Dense, NullSpaceTakesWhatIsWithinItsTolerance) {
  const Eigen::MatrixXd rows = Eigen::Vector2d(1.0, 2e-7).asDiagonal();
  EXPECT_EQ(null_space(rows).cols(), 1);
  EXPECT_EQ(null_space(Eigen::Vector2d(1.0, 4e-7).asDiagonal().toDenseMatrix()).cols(), 0);
}

TEST(Dense, NullSpaceIsOrthonormalAndLosesDependentRows) {
  Eigen::MatrixXd rows(2, 3);
  rows << 1.0, 1.0, 1.0, 0.0, 1.0, -1.0;
  Eigen::MatrixXd null = null_space(rows);
  ASSERT_EQ(null.cols(), 1);
  EXPECT_NEAR((rows * null).norm(), 0.0, kDenseRounding);
  EXPECT_NEAR(null.norm(), 1.0, kDenseRounding);
  rows.row(1) = 2.0 * rows.row(0);
  null = null_space(rows);
  ASSERT_EQ(null.cols(), 2);
  EXPECT_NEAR((rows * null).norm(), 0.0, kDenseRounding);
  EXPECT_TRUE((null.transpose() * null).isIdentity(kDenseRounding));
  EXPECT_EQ(null_space(Eigen::MatrixXd::Zero(1, 4)).cols(), 4);
}

TEST(Dense, InvertsPrecisionsWithTheirDeterminants) {
  Eigen::MatrixXd precision(2, 2);
  precision << 4.0, 2.0, 2.0, 3.0;
  const PrecisionInverse inverse = invert_precision(precision);
  EXPECT_TRUE((precision * inverse.covariance).isIdentity(kDenseRounding));
  EXPECT_NEAR(inverse.log_determinant, std::log(8.0), kDenseRounding);
}

// Two parameters, of scales 1 and 1e-6, of which only the sum is known; the other eigenvalue is negative by
// rounding: their difference is as unknown as rounding allows.
TEST(Dense, InvertsPrecisionsThatRoundingMadeIndefinite) {
  Eigen::MatrixXd precision(2, 2);
  precision << 1.0, 1e6, 1e6, 1e12;
  precision(0, 1) = precision(1, 0) = std::nextafter(1e6, 2e6);
  const PrecisionInverse inverse = invert_precision(precision);
  const double unknown = 0.25 / std::numeric_limits<double>::epsilon();
  EXPECT_NEAR(inverse.covariance(0, 0) / unknown, 1.0, 1e-6);
  EXPECT_NEAR(inverse.covariance(0, 1) / unknown, -1e-6, 1e-12);
  EXPECT_NEAR(inverse.covariance(1, 1) / unknown, 1e-12, 1e-18);
  EXPECT_NEAR(inverse.log_determinant,
              std::log(2.0) + std::log(2.0 * std::numeric_limits<double>::epsilon()) + std::log(1e12), 1e-6);
  precision(0, 0) = -1.0;
  EXPECT_THROW(invert_precision(precision), std::runtime_error);
}

TEST(Dense, SolvesPositiveDefiniteSystemsAndRefusesOthers) {
  Eigen::MatrixXd a(2, 2);
  a << 4.0, 2.0, 2.0, 3.0;
  EXPECT_TRUE(solve_positive_definite(a, Eigen::Vector2d(8.0, 8.0))
                  .isApprox(Eigen::Vector2d(1.0, 2.0), kDenseRounding));
  a(1, 1) = 1.0;
  EXPECT_THROW(solve_positive_definite(a, Eigen::Vector2d(8.0, 8.0)), std::runtime_error);
}

/// By hand, of parts of larger matrices too.
TEST(Dense, MultipliesMatricesAndParts) {
  Eigen::MatrixXd a(3, 3), b(2, 2);
  a << 9.0, 9.0, 9.0, 1.0, 2.0, 9.0, 3.0, 4.0, 9.0;
  b << 5.0, 6.0, 7.0, 8.0;
  const Eigen::MatrixXd expected = (Eigen::MatrixXd(2, 2) << 19.0, 22.0, 43.0, 50.0).finished();
  EXPECT_EQ(product(a.block(1, 0, 2, 2), b), expected);
  EXPECT_EQ(product(Eigen::MatrixXd(2, 0), Eigen::MatrixXd(0, 3)), Eigen::MatrixXd::Zero(2, 3));
}

TEST(Dense, MatricesWithoutRowsOrColumnsAreNoCase) {
  const Eigen::MatrixXd none(0, 0);
  ::testing::internal::CaptureStdout();
  const auto lower = cholesky_lower(none);
  ASSERT_TRUE(lower.has_value());
  EXPECT_EQ(lower->size(), 0);
  EXPECT_EQ(inverse_from_cholesky(none).size(), 0);
  EXPECT_EQ(log_determinant(none), 0.0);
  EXPECT_EQ(invert_precision(none).covariance.size(), 0);
  EXPECT_EQ(eigenvalues(none).size(), 0);
  EXPECT_EQ(null_space(Eigen::MatrixXd(2, 0)).size(), 0);
  EXPECT_EQ(null_space(Eigen::MatrixXd(0, 2)).cols(), 2);
  EXPECT_EQ(solve_positive_definite(none, Eigen::MatrixXd(0, 3)).cols(), 3);
  EXPECT_EQ(least_squares(Eigen::MatrixXd(3, 0), Eigen::Vector3d::Ones()).rank, 0);
  Eigen::MatrixXd outer(0, 0), right(0, 2);
  add_outer_product_upper(nullptr, 0, 3, outer);
  solve_lower(none, right);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "") << "LAPACK writes of what it refuses";
}

}  // namespace
}  // namespace volcal
