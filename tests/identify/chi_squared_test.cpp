#include "volcal/identify/stats/chi_squared.h"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace volcal
