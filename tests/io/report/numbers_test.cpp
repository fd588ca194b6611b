// Numbers as the report writes them.

#include "volcal/identify/report/numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace volcal::report {
namespace {

/// A page that shows a decimal shows one that was computed.
TEST(ReportNumbers, KeepAThousandthHoweverFewDigitsAreAskedFor) {
  EXPECT_EQ(rounded(141.42135, 3), 141.421);
  EXPECT_EQ(rounded(-13436.25541, 5), -13436.255);
  EXPECT_EQ(rounded(0.0123456, 3), 0.0123);
  EXPECT_EQ(rounded(1.23456, 5), 1.2346);
  EXPECT_EQ(rounded(0.0), 0);
  EXPECT_TRUE(rounded(std::nan("")).is_null());
}

}  // namespace
}  // namespace volcal::report
