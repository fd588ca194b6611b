#include "volcal/model/functions/drawn_places.h"

#include <gtest/gtest.h>

#include <cmath>

namespace volcal {
namespace {

/// Coefficients at the nodes of a variable make a straight line of it.
TEST(DrawnPlaces, OfTwoVariablesHaveTheLastNextToEachOther) {
  const TensorBasis basis({{0.0, 10.0, 2}, {-4.0, 4.0, 3}});
  const DrawnPlaces drawn = drawn_places(basis);
  ASSERT_EQ(drawn.axes.size(), 2u);
  EXPECT_TRUE(std::isnan(drawn.third));
  const auto count = static_cast<Eigen::Index>(drawn.axes[1].size());
  ASSERT_EQ(drawn.rows.rows(), static_cast<Eigen::Index>(drawn.axes[0].size()) * count);
  Eigen::VectorXd coefficients(basis.size());
  for (Eigen::Index k = 0; k < coefficients.size(); ++k)
    coefficients[k] = basis.nodes(0)[k / basis.size(1)] + 100.0 * basis.nodes(1)[k % basis.size(1)];
  const Eigen::VectorXd values = drawn.rows * coefficients;
  for (const std::size_t i : {0U, 7U, 40U}) {
    for (const std::size_t j : {0U, 13U, 40U}) {
      EXPECT_NEAR(values[static_cast<Eigen::Index>(i) * count + static_cast<Eigen::Index>(j)],
                  drawn.axes[0][i] / 10.0 + 100.0 * (drawn.axes[1][j] + 4.0) / 8.0, 1e-12);
    }
  }
}

TEST(DrawnPlaces, HoldAThirdVariableWhereItIsAsked) {
  const TensorBasis basis({{0.0, 1.0, 1}, {0.0, 1.0, 1}, {20.0, 30.0, 2}});
  EXPECT_EQ(drawn_places(basis).third, 25.0);
  const DrawnPlaces drawn = drawn_places(basis, 22.5);
  EXPECT_EQ(drawn.third, 22.5);
  Eigen::VectorXd coefficients(basis.size());
  for (Eigen::Index k = 0; k < coefficients.size(); ++k) coefficients[k] = basis.nodes(2)[k % basis.size(2)];
  EXPECT_LT(((drawn.rows * coefficients).array() - 0.25).abs().maxCoeff(), 1e-12);
}

TEST(DrawnPlaces, OfACurveReachFromEndToEnd) {
  const DrawnPlaces drawn = drawn_places(TensorBasis({{-1.0, 3.0, 5}}));
  ASSERT_EQ(drawn.axes.size(), 1u);
  EXPECT_EQ(drawn.axes[0].front(), -1.0);
  EXPECT_EQ(drawn.axes[0].back(), 3.0);
}

}  // namespace
}  // namespace volcal
