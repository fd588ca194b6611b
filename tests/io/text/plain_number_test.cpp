#include "volcal/identify/text/plain_number.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

namespace volcal {
namespace {

constexpr const char* kRest = ",0.123456789012345678\n";  // what must be readable behind a number

/// Characters read, 0 where the number is left to a careful reader.
std::size_t length_read(const std::string& number, double& value, char decimal = '.') {
  const std::string text = number + kRest;
  const char* const end = read_plain_number(text.data(), text.data() + text.size(), decimal, value);
  return end == nullptr ? 0 : static_cast<std::size_t>(end - text.data());
}

TEST(PlainNumber, IsTheDoubleNearestToTheText) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> exponent(-3.0, 6.9);
  for (int i = 0; i < 200'000; ++i) {
    const double size = std::pow(10.0, exponent(random)) * (i % 2 == 0 ? 1.0 : -1.0);
    const std::string number = fmt::format("{:.{}f}", size, i % 8);
    double value = 0.0;
    ASSERT_EQ(length_read(number, value), number.size()) << number;
    ASSERT_EQ(value, std::strtod(number.c_str(), nullptr)) << number;
  }
}

TEST(PlainNumber, SignsZerosAndDecimalCommas) {
  double value = 1.0;
  EXPECT_EQ(length_read("-0", value), 2U);
  EXPECT_TRUE(std::signbit(value) && value == 0.0);
  EXPECT_EQ(length_read("007.50", value), 6U);
  EXPECT_EQ(value, 7.5);
  EXPECT_EQ(length_read("-12,25;", value, ','), 6U);
  EXPECT_EQ(value, -12.25);
  EXPECT_EQ(length_read("12345678.123456", value), 15U);
  EXPECT_EQ(value, 12345678.123456);
}

/// Whatever stands behind the digits is for the caller, who finds no separator there.
TEST(PlainNumber, LeavesEverythingElseToACarefulReader) {
  double value = 0.0;
  for (const char* number : {"", "-", "+1", ".5", "1.", "-.5", "nan", "inf", "--1", "x", " 1", "123456789",
                             "0.123456789", "12345678.1234567", "\"1\""})
    EXPECT_EQ(length_read(number, value), 0U) << number;
  EXPECT_EQ(length_read("1e5", value), 1U);
  EXPECT_EQ(length_read("1.5x", value), 3U);
  const std::string at_end = "1234567.8";
  EXPECT_EQ(read_plain_number(at_end.data(), at_end.data() + at_end.size(), '.', value), nullptr);
}

}  // namespace
}  // namespace volcal
