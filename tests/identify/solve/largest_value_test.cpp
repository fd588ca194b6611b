// Where a curve is largest: cubic B-splines on one piece, worked by hand.

#include "volcal/identify/result/largest_value.h"

#include <gtest/gtest.h>

#include <cmath>

namespace volcal {
namespace {

/// Clamped cubic splines of one piece are Bernstein polynomials: coefficients 0, 1, 0, 0 give 3 x (1 - x)^2,
/// largest at x = 1/3 with 4/9; no place of an equal division by a power of two.
TEST(LargestValue, IsRefinedBetweenThePlacesOfTheGrid) {
  const TensorBasis basis({{0.0, 300.0, 1}});
  Eigen::VectorXd coefficients(4);
  coefficients << 0.0, -1.0, 0.0, 0.0;
  const LargestValue largest = largest_value(basis, coefficients, 0.01 * Eigen::MatrixXd::Identity(4, 4));
  EXPECT_NEAR(largest.value, -4.0 / 9.0, 1e-6);
  EXPECT_NEAR(largest.at.at(0), 100.0, 0.1);
  // The polynomials are 8/27, 12/27, 6/27, 1/27 there.
  EXPECT_NEAR(largest.u, 0.1 * std::sqrt(64.0 + 144.0 + 36.0 + 1.0) / 27.0, 1e-4);
  EXPECT_NEAR(largest.row.dot(coefficients), largest.value, 1e-15);
}

/// 5 at the far end has u = 10 where the median of u is below 0.1. Without a covariance the far end wins.
TEST(LargestValue, WhatIsLargeOnlyBecauseItIsUncertainDoesNotWin) {
  const TensorBasis basis({{0.0, 1.0, 8}});
  Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(11), u = Eigen::VectorXd::Constant(11, 0.1);
  coefficients[0] = 1.0;
  coefficients[10] = 5.0;
  u[10] = 10.0;
  const Eigen::MatrixXd covariance = u.array().square().matrix().asDiagonal();
  const LargestValue largest = largest_value(basis, coefficients, covariance);
  EXPECT_DOUBLE_EQ(largest.at.at(0), 0.0);
  EXPECT_DOUBLE_EQ(largest.value, 1.0);
  EXPECT_DOUBLE_EQ(largest_value(basis, coefficients, {}).at.at(0), 1.0);
}

}  // namespace
}  // namespace volcal
