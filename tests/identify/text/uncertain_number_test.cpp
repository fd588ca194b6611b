// Values with U by the rule of GUM 7.2.6, worked by hand.

#include "volcal/identify/text/uncertain_number.h"

#include <gtest/gtest.h>

namespace volcal {
namespace {

TEST(ValueWithU, HasTheDecimalsOfTwoDigitsOfU) {
  EXPECT_EQ(value_with_u(11.0449, 2.06), "11.0 +- 2.1");
  EXPECT_EQ(value_with_u(4.3912, 0.138), "4.39 +- 0.14");
  EXPECT_EQ(value_with_u(-1.0, 0.2), "-1.00 +- 0.20");
  EXPECT_EQ(value_with_u(120.26, 15.2), "120 +- 15");
}

/// 0.0996 to two digits is 0.10: two decimals, not three.
TEST(ValueWithU, CountsDigitsOfTheRoundedU) { EXPECT_EQ(value_with_u(3.14159, 0.0996), "3.14 +- 0.10"); }

TEST(ValueWithU, NeverWritesMinusZero) { EXPECT_EQ(value_with_u(-0.001, 0.5), "0.00 +- 0.50"); }

TEST(ValueWithU, WithoutUTheValueHasThreeDigits) { EXPECT_EQ(value_with_u(12.345, 0.0), "12.3 +- 0"); }

}  // namespace
}  // namespace volcal
