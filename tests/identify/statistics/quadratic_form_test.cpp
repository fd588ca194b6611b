#include "volcal/identify/statistics/quadratic_form.h"

#include <gtest/gtest.h>

#include <cmath>

#include "volcal/identify/statistics/chi_squared.h"

namespace volcal {
namespace {

/// Weights in pairs a, a, b, b: the sum of two exponential variables with means 2a and 2b.
double hypoexponential(double q, double a, double b) {
  return (a * std::exp(-q / (2.0 * a)) - b * std::exp(-q / (2.0 * b))) / (a - b);
}

TEST(QuadraticForm, PairsOfWeightsHaveAClosedForm) {
  struct Case {
    double a, b, q;
  };
  for (const auto& [a, b, q] :
       {Case{1.0, 0.25, 1.0}, {1.0, 0.25, 5.0}, {1.0, 0.25, 30.0}, {1.0, 0.1, 40.0}, {3.0, 2.0, 60.0}}) {
    const double exact = hypoexponential(q, a, b);
    const double found = log10_quadratic_form_exceedance(q, Eigen::Vector4d(a, a, b, b));
    EXPECT_NEAR(std::pow(10.0, found) / exact, 1.0, 0.06) << a << ' ' << b << ' ' << q;
  }
}

TEST(QuadraticForm, EqualWeightsAreChiSquared) {
  for (const double q : {2.0, 3.0001, 12.0, 90.0}) {
    EXPECT_NEAR(log10_quadratic_form_exceedance(2.0 * q, Eigen::Vector3d::Constant(2.0)),
                log10_chi_squared_exceedance(q, 3.0), 0.03)
        << q;
  }
}

/// A chi-squared with the same mean and variance understates far tails; the weights of a scan's waves.
TEST(QuadraticForm, TailsOfUnequalWeightsAreLonger) {
  Eigen::VectorXd weights(10);
  for (int k = 1; k <= 10; ++k) weights[k - 1] = 1.0 / (k * k);
  const double mean = weights.sum(), squares = weights.squaredNorm();
  const double matched = log10_chi_squared_exceedance(20.0 * mean / squares, mean * mean / squares);
  EXPECT_GT(log10_quadratic_form_exceedance(20.0, weights), matched + 1.0);
}

TEST(QuadraticForm, Edges) {
  EXPECT_EQ(log10_quadratic_form_exceedance(0.0, Eigen::Vector2d(1.0, 2.0)), 0.0);
  EXPECT_EQ(log10_quadratic_form_exceedance(1.0, Eigen::Vector2d(0.0, 0.0)),
            -std::numeric_limits<double>::infinity());
  EXPECT_NEAR(log10_quadratic_form_exceedance(7.0, Eigen::Vector2d(1.0, 0.0)),
              log10_chi_squared_exceedance(7.0, 1.0), 0.03);
}

}  // namespace
}  // namespace volcal
