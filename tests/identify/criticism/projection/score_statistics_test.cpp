// Score tests of columns by hand: what a column of rounding may not do.

#include "volcal/identify/criticism/projection/score_statistics.h"

#include <gtest/gtest.h>

namespace volcal {
namespace {

/// Two columns of which the second is the rounding of a sine at its nodes: g~^T r~ over g~^T g~ is 3e9.
ProjectedColumns with_rounding() {
  ProjectedColumns projected;
  projected.norm = Eigen::Vector2d(10.0, 1e-9);
  projected.score = Eigen::Vector2d(50.0, 3e-9);
  projected.first = {0};
  projected.grams = {Eigen::Vector2d(100.0, 1e-18).asDiagonal()};
  return projected;
}

TEST(ScoreTest, LeavesOutWhatIsNotSeenEvenWhereItIsLargest) {
  const ScoreTest test = score_test(with_rounding(), 0, 2, Eigen::Vector2d::Constant(1.0));
  EXPECT_EQ(test.dof, 1);
  EXPECT_NEAR(test.lm, 50.0 * 50.0 / 100.0, 1e-12);
  EXPECT_NEAR(test.amplitude[0], 0.5, 1e-12);
  EXPECT_EQ(test.amplitude[1], 0.0);
  EXPECT_EQ(test.covariance(1, 1), 0.0);
}

TEST(ScoreTest, TakesAnySizeWithoutALimit) {
  const ScoreTest test = score_test(with_rounding(), 0, 2);
  EXPECT_EQ(test.dof, 2);
  EXPECT_NEAR(test.amplitude[1], 3e9, 1.0);
}

}  // namespace
}  // namespace volcal
