#include "volcal/identify/montecarlo/quantities.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/machines.h"
#include "tests/support/straight_surface.h"

namespace volcal {
namespace {

/// 10 um at the end, where the last spline alone is one: u is that of its coefficient.
TEST(Quantities, OfASurfaceTheLargestValueIsOneAndNoCoefficient) {
  FitResult result;
  result.machine = testing_support::machine_of("w X' b Y Z t");
  testing_support::add_straight_surface(result,
                                        testing_support::stated_surface("EYX", "x", {0.0}, {400.0}, {4}), 0);
  const QuantitySet set = quantities_of(result, 0);
  std::vector<std::size_t> parameters;
  for (std::size_t i = 0; i < set.items.size(); ++i) {
    if (set.items[i].kind == QuantityKind::Parameter) parameters.push_back(i);
  }
  ASSERT_EQ(parameters.size(), 1u);
  const Quantity& largest = set.items[parameters.front()];
  EXPECT_EQ(largest.words(), "curve EYX by x at x = 400");
  EXPECT_EQ(largest.unit, "um");
  EXPECT_NEAR(largest.estimate, testing_support::kLargestOfSurface, 1e-18);
  const Eigen::RowVectorXd row = set.rows.row(static_cast<Eigen::Index>(parameters.front()));
  EXPECT_NEAR((row * result.parameters)(0), largest.estimate, 1e-18);
  EXPECT_NEAR((row * result.covariance).dot(row),
              testing_support::kCoefficientU * testing_support::kCoefficientU, 1e-24);
}

}  // namespace
}  // namespace volcal
