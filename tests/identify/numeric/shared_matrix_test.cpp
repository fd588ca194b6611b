#include "volcal/identify/numeric/shared_matrix.h"

#include <gtest/gtest.h>

namespace volcal {
namespace {

TEST(SharedMatrix, CopiesShareUntilOneIsEdited) {
  SharedMatrix one(Eigen::MatrixXd::Ones(2, 3));
  SharedMatrix other = one;
  EXPECT_EQ(one.data(), other.data());
  other.edit([](Eigen::MatrixXd& matrix) {
    matrix.conservativeResize(2, 4);
    matrix.col(3) << 5.0, 6.0;
  });
  EXPECT_EQ(one.cols(), 3);
  EXPECT_TRUE(one.isOnes());
  EXPECT_EQ(other(1, 3), 6.0);
  EXPECT_EQ(other.whole().data(), other.data());
  EXPECT_EQ((other * Eigen::Vector4d(1.0, 1.0, 1.0, 1.0)).eval(), Eigen::Vector2d(8.0, 9.0));
}

/// What nobody shares is changed where it is.
TEST(SharedMatrix, OwnMatrixIsEditedInPlace) {
  SharedMatrix one(Eigen::MatrixXd::Zero(2, 2));
  const double* const before = one.data();
  one.edit([](Eigen::MatrixXd& matrix) { matrix(0, 1) = 4.0; });
  EXPECT_EQ(one.data(), before);
  EXPECT_EQ(one(0, 1), 4.0);
}

TEST(SharedMatrix, TakesOthersByAssignment) {
  SharedMatrix one;
  EXPECT_EQ(one.size(), 0);
  one = Eigen::MatrixXd::Constant(1, 2, 7.0);
  EXPECT_EQ(one(0, 1), 7.0);
  SharedMatrix other(Eigen::MatrixXd::Zero(3, 1));
  one = other;
  EXPECT_EQ(one.rows(), 3);
  EXPECT_EQ(one.data(), other.data());
  one = one;  // NOLINT: that this changes nothing is what is asked
  EXPECT_EQ(one.rows(), 3);
}

}  // namespace
}  // namespace volcal
