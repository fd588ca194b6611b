#include "volcal/identify/errors/volume/volumetric.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace volcal {
namespace {

using Eigen::Vector3d;

/// By hand, um: (3, 4, 0), (-1, 0, 2), (0, 0, 0). Ranges 3 - (-1) = 4, 4 - 0 = 4, 2 - 0 = 2.
/// |e|^2 = 25, 5, 0: RMS = sqrt(30 / 3) = sqrt(10); max = 5.
TEST(VolumetricFigures, HandWorkedExample) {
  const std::vector<Vector3d> errors = {1e-6 * Vector3d(3, 4, 0), 1e-6 * Vector3d(-1, 0, 2),
                                        Vector3d::Zero()};
  const VolumetricFigures figures = volumetric_figures(errors);
  EXPECT_EQ(figures.points, 3);
  EXPECT_NEAR(figures.range.x(), 4e-6, 1e-18);
  EXPECT_NEAR(figures.range.y(), 4e-6, 1e-18);
  EXPECT_NEAR(figures.range.z(), 2e-6, 1e-18);
  EXPECT_NEAR(figures.rms, std::sqrt(10.0) * 1e-6, 1e-18);
  EXPECT_NEAR(figures.max, 5e-6, 1e-18);
}

TEST(VolumetricFigures, NoPoints) { EXPECT_EQ(volumetric_figures({}).points, 0); }

/// Corners of a square of 2 m about (5, 0, 0) in the xy plane: (6, 0), (4, 0), (5, 1), (5, -1). Errors
/// t + w x arm with t = (1, 2, 3) um and w = (0, 0, 10) urad: arms (1, 0), (-1, 0), (0, 1), (0, -1) give
/// w x arm = 10 (-arm_y, arm_x): (0, 10), (0, -10), (-10, 0), (10, 0) um. Plus a stretch of 4 um outwards in
/// x at the first two points, (4, 0) and (-4, 0), which is no rigid motion: it alone remains.
TEST(WithoutRigidMotion, LeavesOnlyTheDistortion) {
  const std::vector<Vector3d> points = {{6, 0, 0}, {4, 0, 0}, {5, 1, 0}, {5, -1, 0}};
  const std::vector<Vector3d> errors = {1e-6 * Vector3d(1 + 4, 2 + 10, 3), 1e-6 * Vector3d(1 - 4, 2 - 10, 3),
                                        1e-6 * Vector3d(1 - 10, 2, 3), 1e-6 * Vector3d(1 + 10, 2, 3)};
  const auto left = without_rigid_motion(points, errors);
  ASSERT_EQ(left.size(), 4U);
  EXPECT_LT((left[0] - 1e-6 * Vector3d(4, 0, 0)).norm(), 1e-18);
  EXPECT_LT((left[1] - 1e-6 * Vector3d(-4, 0, 0)).norm(), 1e-18);
  EXPECT_LT(left[2].norm(), 1e-18);
  EXPECT_LT(left[3].norm(), 1e-18);
}

/// Two points on a line along x: the turn about x is not determined and nothing may come of it.
TEST(WithoutRigidMotion, PointsOnALine) {
  const std::vector<Vector3d> points = {{0, 0, 0}, {1, 0, 0}};
  const std::vector<Vector3d> errors = {1e-6 * Vector3d(0, 0, 0), 1e-6 * Vector3d(2, 6, 8)};
  const auto left = without_rigid_motion(points, errors);
  EXPECT_LT((left[0] - 1e-6 * Vector3d(-1, 0, 0)).norm(), 1e-18);
  EXPECT_LT((left[1] - 1e-6 * Vector3d(1, 0, 0)).norm(), 1e-18);
}

/// The motion of the first two points, a shift of 2 um along x, is taken from the third as well, which has 5
/// um.
TEST(WithoutRigidMotion, IsThatOfTheFirstPoints) {
  const std::vector<Vector3d> points = {{0, 0, 0}, {1, 0, 0}, {7, 0, 0}};
  const std::vector<Vector3d> errors = {1e-6 * Vector3d(2, 0, 0), 1e-6 * Vector3d(2, 0, 0),
                                        1e-6 * Vector3d(5, 0, 0)};
  const auto left = without_rigid_motion(points, errors, 2);
  EXPECT_LT(left[0].norm(), 1e-18);
  EXPECT_LT(left[1].norm(), 1e-18);
  EXPECT_LT((left[2] - 1e-6 * Vector3d(3, 0, 0)).norm(), 1e-18);
  EXPECT_THROW(without_rigid_motion(points, errors, 4), std::invalid_argument);
}

TEST(WithoutRigidMotion, RefusesListsOfDifferentLength) {
  EXPECT_THROW(without_rigid_motion(std::vector<Vector3d>(2), std::vector<Vector3d>(3)),
               std::invalid_argument);
}

}  // namespace
}  // namespace volcal
