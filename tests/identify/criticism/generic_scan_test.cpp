// What the scans without a catalogue look for, and that they find what is put there.

#include "volcal/identify/criticism/generic_scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/hidden_studies.h"

namespace volcal {
namespace {

using testing_support::model_of_nothing_hidden;
using testing_support::value_of_variable;
using testing_support::variables_of_nothing_hidden;
using testing_support::white_projector;
using testing_support::white_residual;

std::vector<GenericTest> scanned(const Eigen::VectorXd& residual) {
  return generic_scan(model_of_nothing_hidden(), variables_of_nothing_hidden(),
                      white_projector(model_of_nothing_hidden(), residual), 2);
}

bool holds(const std::vector<GenericTest>& tests, const std::vector<std::string>& names,
           const std::string& direction) {
  return std::ranges::any_of(tests, [&](const GenericTest& test) {
    return test.direction == direction && std::ranges::is_permutation(test.variables, names);
  });
}

TEST(GenericScan, LooksForWhatCouldHaveAReason) {
  std::mt19937_64 random(3);
  const std::vector<GenericTest> tests = scanned(white_residual(model_of_nothing_hidden(), random));
  for (const char* along : {"X", "Y", "Z"}) {
    EXPECT_TRUE(holds(tests, {"dir_x", "z"}, along));
    EXPECT_TRUE(holds(tests, {"T_column"}, along));
    EXPECT_TRUE(holds(tests, {"time", "station P1"}, along)) << "a station that drifts";
    EXPECT_FALSE(holds(tests, {"station P1", "x"}, along)) << "the machine does not know its stations";
    EXPECT_FALSE(holds(tests, {"length"}, along));
    EXPECT_FALSE(holds(tests, {"T_column", "elevation"}, along));
  }
  EXPECT_TRUE(holds(tests, {"length", "T_column"}, "beam"));
  EXPECT_TRUE(holds(tests, {"station P1"}, "beam"));
  EXPECT_FALSE(holds(tests, {"dir_x"}, "beam"));
  EXPECT_FALSE(holds(tests, {"x", "length"}, "beam"));
  EXPECT_TRUE(std::ranges::none_of(tests, [](const GenericTest& test) { return test.variables.empty(); }));
}

TEST(GenericScan, FindsAProductOfTwoVariables) {
  std::mt19937_64 random(4);
  const Eigen::VectorXd moved = model_of_nothing_hidden()
                                    .direction(0)
                                    .cwiseProduct(value_of_variable("T_column"))
                                    .cwiseProduct(value_of_variable("dir_y"));
  const std::vector<GenericTest> tests =
      scanned(white_residual(model_of_nothing_hidden(), random) + 0.5e-6 * moved);
  const auto least = std::ranges::min_element(tests, {}, &GenericTest::log10_p);
  EXPECT_THAT(least->variables, ::testing::UnorderedElementsAre("T_column", "dir_y"));
  EXPECT_EQ(least->direction, "X");
  EXPECT_LT(least->log10_p, -10.0);
}

}  // namespace
}  // namespace volcal
