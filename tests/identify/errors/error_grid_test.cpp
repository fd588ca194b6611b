#include "volcal/identify/errors/error_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/error_oracles.h"
#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "tests/support/random_matrix.h"
#include "tests/support/random_results.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/error_tables.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using testing_support::machine_of;
using testing_support::random_machine;
using testing_support::random_result;
using testing_support::random_vector;
using testing_support::uniform;

constexpr double kSameAsPlain = 1e-12;  // of the largest

void expect_same_as_plain(const FitResult& result, int per_axis) {
  const std::vector<VolumetricError> grid = testing::volumetric_grid(result, per_axis, {});
  const std::vector<AxisPosition> positions = grid_positions(result.machine, per_axis);
  ASSERT_EQ(grid.size(), positions.size() * result.machine.tools.size());
  double value = 0.0, square = 0.0, value_difference = 0.0, square_difference = 0.0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Tool& tool = result.machine.tools[i / positions.size()];
    const VolumetricError plain = volumetric_error(result, positions[i % positions.size()], tool);
    ASSERT_EQ(grid[i].position, plain.position);
    ASSERT_EQ(grid[i].tool, plain.tool);
    value = std::max(value, plain.value.cwiseAbs().maxCoeff());
    square = std::max(square, plain.u.cwiseAbs2().maxCoeff());
    value_difference = std::max(value_difference, (grid[i].value - plain.value).cwiseAbs().maxCoeff());
    square_difference =
        std::max(square_difference, (grid[i].u.cwiseAbs2() - plain.u.cwiseAbs2()).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(square, 0.0);
  EXPECT_LT(value_difference, kSameAsPlain * value) << result.machine.structure.code;
  EXPECT_LT(square_difference, kSameAsPlain * square) << result.machine.structure.code;
}

TEST(ErrorGrid, IsTheVolumetricErrorAtEveryNodeOfAnyMachine) {
  std::mt19937_64 random(41);
  for (int i = 0; i < 30; ++i) expect_same_as_plain(random_result(random_machine(random), random), 3);
}

TEST(ErrorGrid, ParallelAxesStandAtHome) {
  std::mt19937_64 random(44);
  for (const char* letters : {"XYZW", "XZW", "XYZUVW", "XYZWBC"}) {
    for (int i = 0; i < 4; ++i) {
      Machine machine = random_machine(random, letters);
      for (Axis& axis : machine.axes) axis.home = is_parallel(axis.name) ? 0.3 : 0.0;
      const FitResult result = random_result(machine, random);
      for (const AxisPosition& position : grid_positions(machine, 2)) {
        for (const AxisName axis : machine.parallel_axes()) EXPECT_EQ(position[index_of(axis)], 0.3);
      }
      expect_same_as_plain(result, 3);
    }
  }
}

TEST(ErrorGrid, AxesThatTheMachineLacksHaveOneNode) {
  std::mt19937_64 random(42);
  for (const char* code : {"wX'bZt", "wC'X'bYt", "wbAYt", "wZ'bt"})
    expect_same_as_plain(random_result(machine_of(code), random), 4);
}

TEST(ErrorGrid, CovariancesAreThoseOfThePropagationThroughTheDerivatives) {
  std::mt19937_64 random(43);
  for (int i = 0; i < 10; ++i) {
    const FitResult result = random_result(random_machine(random), random);
    const Tool& tool = result.machine.tools[1];
    const AxisGrid axes = axis_grid(result.machine, 3);
    const std::vector<Covariance3> covariances = ErrorGrid(result, tool, axes).displacement_covariances();
    const std::vector<AxisPosition> positions = axes.positions();
    ASSERT_EQ(covariances.size(), positions.size());
    for (std::size_t k = 0; k < positions.size(); ++k) {
      const Eigen::MatrixXd rows = ErrorField(result, tool).rows(positions[k]).topRows<3>();
      const Eigen::Matrix3d plain = rows * result.covariance * rows.transpose();
      EXPECT_LT((covariances[k].matrix() - plain).cwiseAbs().maxCoeff(), kSameAsPlain * plain.maxCoeff());
    }
  }
}

TEST(ErrorGrid, NodesRunOverTheTravelInTheOrderOfTheStructure) {
  const AxisGrid grid = axis_grid(machine_of("wZ'X'bCt"), 3);
  EXPECT_EQ(grid.axes, (std::array{AxisName::Y, AxisName::Z, AxisName::X}));
  EXPECT_EQ(grid.nodes[0], std::vector<double>{0.0});
  EXPECT_EQ(grid.nodes[1], (std::vector<double>{0.0, 0.5, 1.0}));
  EXPECT_EQ(grid.positions()[1], (AxisPosition{0.5, 0.0, 0.0}));
  EXPECT_EQ(axis_grid(machine_of("wZ'bt"), 1).nodes[2], std::vector<double>{0.5});
}

}  // namespace
}  // namespace volcal
