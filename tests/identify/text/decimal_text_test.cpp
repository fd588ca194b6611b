#include "volcal/identify/text/decimal_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

namespace volcal {
namespace {

std::string decimal(double value, int decimals) {
  fmt::memory_buffer text;
  append_decimal(value, decimals, text);
  return fmt::to_string(text);
}

TEST(DecimalText, WritesNoMoreThanItMust) {
  EXPECT_EQ(decimal(0.0, 6), "0");
  EXPECT_EQ(decimal(-0.0, 6), "0");
  EXPECT_EQ(decimal(-4e-7, 6), "0");
  EXPECT_EQ(decimal(12.5, 7), "12.5");
  EXPECT_EQ(decimal(-0.25, 6), "-0.25");
  EXPECT_EQ(decimal(3.0, 9), "3");
  EXPECT_EQ(decimal(-1000.000001, 6), "-1000.000001");
  EXPECT_EQ(decimal(0.0000005, 6), "0.000001");
  EXPECT_EQ(decimal(0.1, 0), "0");
  EXPECT_EQ(decimal(1e20, 6), "1e+20");
  EXPECT_EQ(decimal(std::numeric_limits<double>::quiet_NaN(), 6), "nan");
}

TEST(DecimalText, IsTheNumberToTheDecimalsAskedFor) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 20000; ++i) {
    const double value = uniform(random) * std::pow(10.0, 5.0 * uniform(random));
    for (const int decimals : {0, 3, 6, 7}) {
      const double half = 0.5 * std::pow(10.0, -decimals);
      EXPECT_NEAR(std::stod(decimal(value, decimals)), value, half * (1.0 + 1e-6)) << value;
    }
  }
}

}  // namespace
}  // namespace volcal
