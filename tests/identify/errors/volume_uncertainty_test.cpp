#include "volcal/identify/errors/volume/volume_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/support/error_oracles.h"
#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "tests/support/random_matrix.h"
#include "volcal/identify/compensation/checks/volume_check.h"
#include "volcal/identify/errors/volume/volumetric.h"

namespace volcal {
namespace {

using testing_support::machine_of;

Machine machine_with_tool() {
  Machine machine = machine_of("wX'bYZt");
  machine.tools = {{"side", {0.1, 0.05, -0.2}, 0.0}};
  return machine;
}

struct PosesInVolume {
  std::vector<AxisPosition> positions;
  std::vector<ApproachDirection> directions;
};

PosesInVolume poses_in(const Machine& machine) {
  PosesInVolume poses;
  for (const VolumePoint& point : volume_points(machine, 2)) {
    poses.positions.push_back(point.position);
    poses.directions.push_back(point.direction);
  }
  return poses;
}

// EXX = q / (1 m) times a value of u = 1 um at 1 m, by a polyline of one piece: at the ends of travel +-0.5
// um beside the mean, which no turn takes up.
TEST(VolumeUncertainty, IsTheHandCalculation) {
  FitResult result =
      testing::result_with(machine_with_tool(), {.functions = {{"EXX", [](double) { return 0.0; }}}}, 1);
  result.covariance(1, 1) = 1e-12;
  const std::vector<AxisPosition> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                             {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
  const std::vector<ApproachDirection> directions(corners.size());
  EXPECT_NEAR(volume_uncertainty(result, result.machine.tools[0], {}, corners, directions), 0.5e-6, 1e-15);
  result.covariance.setZero();
  EXPECT_EQ(volume_uncertainty(result, result.machine.tools[0], {}, corners, directions), 0.0);
}

// EYX of u = 1 um in the middle of X and nothing at its ends, on a machine that has X alone: less the mean
// -1/3, 2/3, -1/3 um, root mean square sqrt(2/9) um.
TEST(VolumeUncertainty, CountsComponentsAlongWhichNoAxisMoves) {
  Machine machine = machine_of("w b X t");
  machine.tools = {{"short", {0.0, 0.0, 0.0}, 0.0}};
  FitResult result = testing::result_with(machine, {.functions = {{"EYX", [](double) { return 0.0; }}}}, 2);
  result.covariance(1, 1) = 1e-12;
  const std::vector<AxisPosition> places = {{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}};
  const std::vector<ApproachDirection> directions(places.size());
  EXPECT_NEAR(volume_uncertainty(result, machine.tools[0], {}, places, directions),
              std::sqrt(2.0 / 9.0) * 1e-6, 1e-12);
}

// With C = R R^T the trace is the sum over the columns of R of what their displacements leave after a rigid
// motion, each evaluated as an error of its own.
TEST(VolumeUncertainty, IsTheSumOverTheRootsOfTheCovariance) {
  const auto bend = [](double q) { return 1e-6 * q * q; };
  FitResult result =
      testing::result_with(machine_with_tool(),
                           {.functions = {{"EXX", bend}, {"EAX", bend}, {"EYZ", bend}, {"EBY", bend}},
                            .locations = {{"EC0Y", 1e-6}},
                            .reversals = {{"EXX", 2e-6}, {"EYY", 1e-6}, {"EBY", 1e-6}}},
                           5);
  std::mt19937_64 random(7);
  const Eigen::MatrixXd root = 1e-6 * test::random_matrix(random, result.layout.size, result.layout.size);
  result.covariance = root * root.transpose();
  const PosesInVolume poses = poses_in(result.machine);
  double squares = 0.0;
  for (Eigen::Index column = 0; column < root.cols(); ++column) {
    FitResult shifted = result;
    shifted.parameters = root.col(column);
    const DisplacementField displacements =
        testing::plain_displacement_field(shifted, result.machine.tools[0], {});
    std::vector<Eigen::Vector3d> places, errors;
    for (std::size_t i = 0; i < poses.positions.size(); ++i) {
      places.emplace_back(poses.positions[i][0], poses.positions[i][1], poses.positions[i][2]);
      errors.push_back(displacements(poses.positions[i], poses.directions[i]));
    }
    squares += std::pow(volumetric_figures(without_rigid_motion(places, errors)).rms, 2);
  }
  const double u = volume_uncertainty(result, result.machine.tools[0], {}, poses.positions, poses.directions);
  EXPECT_NEAR(u, std::sqrt(squares), 1e-9 * u);
}

}  // namespace
}  // namespace volcal
