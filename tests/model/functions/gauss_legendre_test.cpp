#include "volcal/model/functions/gauss_legendre.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace volcal {
namespace {

/// Two points: +-1/sqrt(3), weights 1. Three points: 0, +-sqrt(3/5), weights 8/9, 5/9.
TEST(GaussLegendre, RulesOfTwoAndThreePoints) {
  const GaussLegendre two = gauss_legendre(2);
  EXPECT_NEAR(two.points[1], 1.0 / std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(two.weights[0], 1.0, 1e-15);
  const GaussLegendre three = gauss_legendre(3);
  EXPECT_EQ(three.points[1], 0.0);
  EXPECT_NEAR(three.points[0], -std::sqrt(0.6), 1e-15);
  EXPECT_NEAR(three.weights[1], 8.0 / 9.0, 1e-15);
  EXPECT_NEAR(three.weights[2], 5.0 / 9.0, 1e-15);
}

TEST(GaussLegendre, IntegratesPolynomialsUpToDegreeTwiceThePointsMinusOne) {
  for (int n = 1; n <= 40; ++n) {
    const GaussLegendre rule = gauss_legendre(n);
    for (int power = 0; power < 2 * n; ++power) {
      double integral = 0.0;
      for (std::size_t i = 0; i < rule.points.size(); ++i) {
        integral += rule.weights[i] * std::pow(rule.points[i], power);
      }
      EXPECT_NEAR(integral, power % 2 == 0 ? 2.0 / (power + 1) : 0.0, 2e-14)
          << n << " points, power " << power;
    }
  }
}

TEST(GaussLegendre, NeedsAPoint) { EXPECT_THROW(gauss_legendre(0), std::invalid_argument); }

}  // namespace
}  // namespace volcal
