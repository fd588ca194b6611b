#include "volcal/identify/errors/volume/remaining_error.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <vector>

namespace volcal {
namespace {

using Eigen::Vector3d;

/// Corners of a square of 2 m in the xy plane; four parameters: a shift along x, a turn about z, a stretch
/// along x (displacement = x) and a shear (displacement along x = y), of which half is a turn.
const std::vector<Vector3d> kCorners = {{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}};

Eigen::MatrixXd derivatives() {
  Eigen::MatrixXd rows(12, 4);
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Vector3d& p = kCorners[static_cast<std::size_t>(i)];
    rows.middleRows<3>(3 * i) << 1, -p.y(), p.x(), p.y(),  //
        0, p.x(), 0, 0,                                    //
        0, 0, 0, 0;
  }
  return rows;
}

/// By hand: shift and turn leave nothing; the stretch with u = 2 um leaves 2 um in x at each corner; a shear
/// of y to x of 4 um/m is a turn of -2 urad and a pure shear of 2 um in x and in y.
TEST(RemainingErrors, UncertaintyIsThatOfTheDistortionAlone) {
  const Eigen::Vector4d u(100e-6, 50e-6, 2e-6, 0.0);
  Eigen::MatrixXd covariance = u.cwiseAbs2().asDiagonal();
  for (const Vector3d& each : RemainingErrors(covariance).at(kCorners, derivatives()).u) {
    EXPECT_LT((each - Vector3d(2e-6, 0, 0)).norm(), 1e-15);
  }
  covariance = Eigen::Vector4d(0.0, 0.0, 0.0, 16e-12).asDiagonal();
  for (const Vector3d& each : RemainingErrors(covariance).at(kCorners, derivatives()).u) {
    EXPECT_LT((each - Vector3d(2e-6, 2e-6, 0)).norm(), 1e-15);
  }
}

/// Stretch and shear that err together, -1: a field s (x - y, 0, 0) of which the shear's half is a turn. u in
/// x is s |x - y / 2|, which is s / 2 on one diagonal and 3 s / 2 on the other.
TEST(RemainingErrors, CorrelationIsTakenIntoAccount) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(4, 4);
  covariance.bottomRightCorner<2, 2>() << 4e-12, -4e-12, -4e-12, 4e-12;
  const auto u = RemainingErrors(covariance).at(kCorners, derivatives()).u;
  EXPECT_NEAR(u[0].x(), 1e-6, 1e-14);
  EXPECT_NEAR(u[1].x(), 3e-6, 1e-14);
  EXPECT_NEAR(u[2].x(), 1e-6, 1e-14);
  EXPECT_NEAR(u[3].x(), 3e-6, 1e-14);
}

/// One unknown stretch: the example is the stretch times one normal value, the same at every corner and for
/// another set of points.
TEST(RemainingErrors, ExampleIsOneOfTheFieldsPossible) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(4, 4);
  covariance(2, 2) = 4e-12;
  const RemainingErrors errors(covariance);
  const auto example = errors.at(kCorners, derivatives()).example;
  const double drawn = example[0].x() / 2e-6;
  EXPECT_GT(std::abs(drawn), 1e-3);
  EXPECT_LT(std::abs(drawn), 5.0);
  for (std::size_t i = 0; i < kCorners.size(); ++i) {
    EXPECT_LT((example[i] - Vector3d(2e-6 * drawn * kCorners[i].x(), 0, 0)).norm(), 1e-15);
  }
  const std::vector<Vector3d> pair = {kCorners[0], kCorners[1]};
  EXPECT_NEAR(errors.at(pair, derivatives().topRows<6>()).example[0].x(), 2e-6 * drawn, 1e-15);
}

}  // namespace
}  // namespace volcal
