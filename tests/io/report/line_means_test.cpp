#include "volcal/identify/report/values/line_means.h"

#include <gtest/gtest.h>

#include <cmath>

namespace volcal::report {
namespace {

/// Four readings of sigma 2 on four lines, 1, -1, 1, -1: mean 0, of independent readings 2 / sqrt(4) = 1; the
/// lines scatter less: sqrt(4/3 x 4) / 4 = 0.577.
TEST(LineMean, IndependentReadingsHaveTheirOwnUncertainty) {
  LineMean mean;
  for (int line = 0; line < 4; ++line) mean.add(line % 2 == 0 ? 1.0 : -1.0, 2.0, 0, line);
  EXPECT_EQ(mean.count(), 4U);
  EXPECT_DOUBLE_EQ(mean.mean(), 0.0);
  EXPECT_DOUBLE_EQ(mean.rms(), 1.0);
  EXPECT_DOUBLE_EQ(mean.standard_u(), 1.0);
}

/// Two lines of 50 readings each, at 3 and at 1, sigma 0.1: the mean is 2, of independent readings known to
/// 0.01; the sums of the lines deviate by +-50, so u = sqrt(2 x (50^2 + 50^2)) / 100 = 1.
TEST(LineMean, LinesThatDifferSayHowLittleTheyTell) {
  LineMean mean;
  for (int k = 0; k < 50; ++k) {
    mean.add(3.0, 0.1, 0, 0);
    mean.add(1.0, 0.1, 0, 1);
  }
  EXPECT_DOUBLE_EQ(mean.mean(), 2.0);
  EXPECT_NEAR(mean.standard_u(), 1.0, 1e-12);
}

/// Lines of different setups are different lines.
TEST(LineMean, OneLineAloneSaysNothingOfTheScatterBetweenLines) {
  LineMean one, two;
  for (int k = 0; k < 4; ++k) {
    one.add(k, 1.0, 0, 0);
    two.add(k, 1.0, static_cast<std::size_t>(k), 0);
  }
  EXPECT_DOUBLE_EQ(one.standard_u(), 0.5);
  EXPECT_NEAR(two.standard_u(), std::sqrt(4.0 / 3.0 * 5.0) / 4.0, 1e-12);
  EXPECT_EQ(LineMean().standard_u(), 0.0);
}

}  // namespace
}  // namespace volcal::report
