#include "volcal/identify/errors/plane_tables.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/machines.h"

namespace volcal {
namespace {

using Eigen::Vector3d;

/// Any sum of terms of two indices each.
Vector3d field(std::size_t i, std::size_t j, std::size_t k) {
  const auto x = static_cast<double>(i), y = static_cast<double>(j), z = static_cast<double>(k);
  return {std::sin(x * y) + z, std::cos(y * z) - x * x, std::exp(-x) * z + y * std::sqrt(z + 1.0)};
}

PlaneTables random_tables(const std::array<std::size_t, 3>& nodes, std::mt19937_64& random) {
  PlaneTables tables(nodes);
  for (auto* table : {&tables.first_second, &tables.first_third, &tables.second_third}) {
    for (Vector3d& vector : *table) vector = testing_support::random_vector(random, 1.0);
  }
  return tables;
}

TEST(PlaneTables, ThreePlanesHoldAFieldWithoutTermsOfThreeAxes) {
  const std::array<std::size_t, 3> nodes = {5, 4, 7};
  const std::vector<Vector3d> sums = sum_planes(sample_planes(nodes, field));
  for (std::size_t i = 0; i < nodes[0]; ++i) {
    for (std::size_t j = 0; j < nodes[1]; ++j) {
      for (std::size_t k = 0; k < nodes[2]; ++k) {
        const Vector3d& sum = sums[(i * nodes[1] + j) * nodes[2] + k];
        EXPECT_LT((sum - field(i, j, k)).cwiseAbs().maxCoeff(), 1e-13) << i << " " << j << " " << k;
      }
    }
  }
}

/// Rows of any length, at any place in the caches' lines; the large ones are written past the caches.
TEST(PlaneTables, SumsAreTheSameToTheBitForEveryShapeAndNumberOfThreads) {
  std::mt19937_64 random(7);
  for (const std::array<std::size_t, 3>& nodes :
       {std::array<std::size_t, 3>{1, 1, 1}, {2, 3, 1}, {3, 2, 5}, {2, 2, 8}, {1, 4, 17}, {40, 61, 601}}) {
    const PlaneTables tables = random_tables(nodes, random);
    for (const int threads : {1, 2}) {
      std::vector<Vector3d> sums(tables.size());
      sum_planes(tables, threads, sums);
      bool same = true;
      for (std::size_t n = 0; n < sums.size(); ++n) {
        const std::size_t i = n / nodes[2] / nodes[1], j = n / nodes[2] % nodes[1], k = n % nodes[2];
        const Vector3d plain = tables.first_third[i * nodes[2] + k] + tables.second_third[j * nodes[2] + k] +
                               tables.first_second[i * nodes[1] + j];
        same = same && sums[n] == plain;
      }
      EXPECT_TRUE(same) << nodes[2];
    }
  }
}

TEST(PlaneTables, RefusesAFieldOfAnotherSize) {
  std::vector<Vector3d> field_of_another(3);
  EXPECT_THROW(sum_planes(PlaneTables({2, 1, 1}), 1, field_of_another), std::invalid_argument);
  EXPECT_TRUE(sum_planes(PlaneTables({0, 2, 2})).empty());
}

}  // namespace
}  // namespace volcal
