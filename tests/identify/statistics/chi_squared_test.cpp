#include "volcal/identify/statistics/chi_squared.h"

#include <gtest/gtest.h>

#include <cmath>

#include "volcal/identify/statistics/log_gamma.h"

namespace volcal {
namespace {

/// Two degrees of freedom: exp(-x / 2). One: erfc(sqrt(x / 2)). Four: exp(-x / 2) (1 + x / 2).
TEST(ChiSquared, ClosedForms) {
  for (const double chi2 : {0.01, 1.0, 5.99, 40.0, 300.0}) {
    const auto near = [&](double dof, double expected) {
      EXPECT_NEAR(chi_squared_exceedance(chi2, dof) / expected, 1.0, 1e-9) << chi2 << ' ' << dof;
    };
    near(1, std::erfc(std::sqrt(chi2 / 2.0)));
    near(2, std::exp(-chi2 / 2.0));
    near(4, std::exp(-chi2 / 2.0) * (1.0 + chi2 / 2.0));
  }
}

/// Printed tables: 95 % quantile 18.307 of 10 degrees of freedom, 99 % quantile 135.807 of 100.
TEST(ChiSquared, PrintedQuantiles) {
  EXPECT_NEAR(chi_squared_exceedance(18.307, 10), 0.05, 1e-5);
  EXPECT_NEAR(chi_squared_exceedance(135.807, 100), 0.01, 1e-5);
}

TEST(ChiSquared, EdgesAndLargeSamples) {
  EXPECT_EQ(chi_squared_exceedance(0.0, 3), 1.0);
  EXPECT_NEAR(chi_squared_exceedance(1e6, 1e6), 0.5, 1e-3);
  EXPECT_LT(chi_squared_exceedance(3000.0, 10), 1e-300);
}

/// exp(-x / 2) far below the smallest number; where both exist, the two functions agree.
TEST(ChiSquared, LogarithmsOfFarTails) {
  EXPECT_NEAR(log10_chi_squared_exceedance(5000.0, 2), -2500.0 / std::log(10.0), 1e-9);
  for (const double chi2 : {3.0, 150.0, 260.0, 600.0}) {
    for (const double dof : {1.0, 3.0, 8.0}) {
      EXPECT_NEAR(log10_chi_squared_exceedance(chi2, dof), std::log10(chi_squared_exceedance(chi2, dof)),
                  1e-9);
    }
  }
  EXPECT_NEAR(chi_squared_quantile(-2.0, 100), 135.807, 1e-3);
}

/// (z_0.975 + z_0.8)^2 = 7.849 for one degree of freedom; 9.635 for two and 10.903 for three from tables of
/// the noncentral distribution (level 0.05, power 0.8).
TEST(ChiSquared, DetectableNoncentrality) {
  const double level = std::log10(0.05);
  EXPECT_NEAR(detectable_noncentrality(level, 1, 0.8), 7.849, 0.001);
  EXPECT_NEAR(detectable_noncentrality(level, 2, 0.8), 9.635, 0.001);
  EXPECT_NEAR(detectable_noncentrality(level, 3, 0.8), 10.903, 0.001);
}

/// Two-sided 5 % of Student's t with 10 degrees of freedom is 2.228139; with two amplitudes the tail is
/// (1 + chi2 / freedom)^(-freedom / 2).
TEST(ChiSquared, OfAnEstimatedVarianceHasTheTailOfF) {
  EXPECT_NEAR(exceedance_of_estimated(2.228139 * 2.228139, 1.0, 10.0), 0.05, 1e-7);
  EXPECT_NEAR(exceedance_of_estimated(30.0, 2.0, 16.0), std::pow(1.0 + 30.0 / 16.0, -8.0), 1e-12);
  EXPECT_NEAR(exceedance_of_estimated(30.0, 2.0, 1e5), std::pow(1.0 + 30.0 / 1e5, -5e4), 1e-12);
  EXPECT_DOUBLE_EQ(exceedance_of_estimated(30.0, 3.0, HUGE_VAL), chi_squared_exceedance(30.0, 3.0));
  EXPECT_DOUBLE_EQ(exceedance_of_estimated(0.0, 2.0, 16.0), 1.0);
}

/// The same tail with two amplitudes, near and where the probability itself is lost.
TEST(ChiSquared, LogarithmOfTheTailOfF) {
  const auto tail = [](double chi2, double freedom) {
    return -0.5 * freedom * std::log10(1.0 + chi2 / freedom);
  };
  EXPECT_NEAR(log10_exceedance_of_estimated(30.0, 2.0, 16.0), tail(30.0, 16.0), 1e-9);
  EXPECT_NEAR(log10_exceedance_of_estimated(1e6, 2.0, 400.0), tail(1e6, 400.0), 0.5);
  EXPECT_NEAR(log10_exceedance_of_estimated(5000.0, 2.0, 4000.0), tail(5000.0, 4000.0), 0.5);
  EXPECT_DOUBLE_EQ(log10_exceedance_of_estimated(30.0, 3.0, HUGE_VAL),
                   log10_chi_squared_exceedance(30.0, 3.0));
}

TEST(LogGamma, IsThatOfTheStandardLibrary) {
  for (const double x : {0.5, 1.0, 3.0, 17.25, 1e3, -0.5}) EXPECT_EQ(log_gamma(x), std::lgamma(x)) << x;
  EXPECT_NEAR(log_gamma(6.0), std::log(120.0), 1e-14);
}

}  // namespace
}  // namespace volcal
