#include "volcal/identify/montecarlo/quantities.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/machines.h"
#include "tests/support/random_results.h"
#include "tests/support/straight_surface.h"
#include "volcal/identify/errors/volume/error_budget.h"
#include "volcal/identify/errors/volume/volume_points.h"

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
  EXPECT_EQ(largest.words(), "curve EYX by x at x = 400 mm");
  EXPECT_EQ(largest.unit, "um");
  EXPECT_NEAR(largest.estimate, testing_support::kLargestOfSurface, 1e-18);
  const Eigen::RowVectorXd row = set.rows.row(static_cast<Eigen::Index>(parameters.front()));
  EXPECT_NEAR((row * result.parameters)(0), largest.estimate, 1e-18);
  EXPECT_NEAR((row * result.covariance).dot(row),
              testing_support::kCoefficientU * testing_support::kCoefficientU, 1e-24);
}

/// As in budgets, whose one tool without a name is the spindle reference.
TEST(Quantities, OfAMachineWithoutToolsAreOfItsSpindleReference) {
  std::mt19937_64 random(11);
  FitResult result = testing_support::random_result(testing_support::machine_of("w X' b Y Z t"), random);
  result.machine.tools.clear();
  const QuantitySet set = quantities_of(result, 3);
  ASSERT_EQ(set.volumes.size(), 1U);
  const BudgetLine total = error_budget(result, result.machine.functional_tools().front(),
                                        default_conditions(result), kVolumeCells)
                               .total;
  const Quantity &rms = set.items[set.volumes[0].rms], &largest = set.items[set.volumes[0].largest];
  EXPECT_NEAR(rms.estimate, total.rms, 1e-12);
  EXPECT_NEAR(largest.estimate, total.max, 1e-12);
  EXPECT_EQ(rms.words(), "volumetric error, rms, spindle reference");
  const auto on_grid = std::ranges::count(set.items, QuantityKind::VolumetricError, &Quantity::kind);
  EXPECT_GT(on_grid, 3 * 26 - 1) << "three components at all nodes of the grid but home";
}

}  // namespace
}  // namespace volcal
