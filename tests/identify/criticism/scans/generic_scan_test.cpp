// What the scans without a catalogue look for, and that they find what is put there.

#include "volcal/identify/criticism/scans/generic_scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "tests/support/hidden_studies.h"
#include "volcal/identify/criticism/projection/score_statistics.h"

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
    return name_of(test.direction.value()) == direction &&
           std::ranges::is_permutation(names_of(test.variables), names);
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
  std::set<std::string> rotations;
  for (const GenericTest& test : tests) {
    if (!test.rotation) continue;
    rotations.insert(test.rotation->name());
    for (const std::string& name : names_of(test.variables))
      EXPECT_FALSE(name.starts_with("station") || name == "length" || name == "elevation")
          << test.rotation->name();
  }
  EXPECT_EQ(rotations,
            (std::set<std::string>{"EAX", "EBX", "ECX", "EAY", "EBY", "ECY", "EAZ", "EBZ", "ECZ"}));
  EXPECT_TRUE(std::ranges::none_of(tests, [](const GenericTest& test) { return test.variables.empty(); }));
}

TEST(GenericScan, FindsAProductOfTwoVariables) {
  std::mt19937_64 random(4);
  const Eigen::VectorXd moved = model_of_nothing_hidden()
                                    .direction(ScanDirection::X)
                                    .cwiseProduct(value_of_variable("T_column"))
                                    .cwiseProduct(value_of_variable("dir_y"));
  const std::vector<GenericTest> tests =
      scanned(white_residual(model_of_nothing_hidden(), random) + 0.5e-6 * moved);
  const auto least = std::ranges::min_element(tests, {}, &GenericTest::log10_p);
  EXPECT_THAT(names_of(least->variables), ::testing::UnorderedElementsAre("T_column", "dir_y"));
  EXPECT_EQ(least->direction, ScanDirection::X);
  EXPECT_LT(least->log10_p, -10.0);
}

const GenericTest& least_probable(const std::vector<GenericTest>& tests) {
  return *std::ranges::min_element(tests, {}, &GenericTest::log10_p);
}

/// Two temperatures that swing several times while each station measures.
std::vector<ScanVariable> two_temperatures() {
  const auto count = static_cast<Eigen::Index>(model_of_nothing_hidden().size());
  const Eigen::ArrayXd reading = Eigen::ArrayXd::LinSpaced(count, 0.0, static_cast<double>(count - 1));
  std::vector<ScanVariable> variables;
  add_scan_variable(variables, {.kind = Variable::Kind::Temperature, .subject = "air"},
                    (0.13 * reading).sin().matrix());
  add_scan_variable(variables, {.kind = Variable::Kind::Temperature, .subject = "column"},
                    (0.31 * reading).cos().matrix());
  return variables;
}

std::vector<GenericTest> scanned(const Eigen::VectorXd& residual,
                                 const std::vector<ScanVariable>& variables) {
  return generic_scan(model_of_nothing_hidden(), variables,
                      white_projector(model_of_nothing_hidden(), residual), 2);
}

/// A tilt that a temperature brings about shows as a displacement, too, but less.
TEST(GenericScan, FindsARotationByItsArms) {
  std::mt19937_64 random(5);
  const LinearModel& model = model_of_nothing_hidden();
  const std::vector<ScanVariable> variables = two_temperatures();
  const Eigen::VectorXd moved = model.motion(*ErrorSymbol::parse("EAZ")).cwiseProduct(variables[0].value);
  const std::vector<GenericTest> tests = scanned(white_residual(model, random) + 10e-6 * moved, variables);
  const GenericTest& least = least_probable(tests);
  EXPECT_THAT(names_of(least.variables), ::testing::ElementsAre("T_air"));
  EXPECT_EQ(least.rotation, (ErrorSymbol{Component::A, AxisName::Z}));
  EXPECT_THAT(least.direction, ::testing::AnyOf(ScanDirection::Y, ScanDirection::Z));
  double as_displacement = 0.0;
  for (const GenericTest& test : tests) {
    if (!test.rotation) as_displacement = std::min(as_displacement, test.log10_p);
  }
  EXPECT_LT(least.log10_p, as_displacement - 5.0);
}

TEST(GenericScan, FindsADisplacementInSeveralDirectionsAtOnce) {
  std::mt19937_64 random(6);
  const LinearModel& model = model_of_nothing_hidden();
  const std::vector<ScanVariable> variables = two_temperatures();
  const Eigen::VectorXd moved = (model.direction(ScanDirection::X) - model.direction(ScanDirection::Y) +
                                 0.8 * model.direction(ScanDirection::Z))
                                    .cwiseProduct(variables[0].value);
  const std::vector<GenericTest> tests = scanned(white_residual(model, random) + 1e-6 * moved, variables);
  const GenericTest& least = least_probable(tests);
  EXPECT_THAT(names_of(least.variables), ::testing::ElementsAre("T_air"));
  EXPECT_EQ(least.rotation, std::nullopt);
  EXPECT_THAT(least.direction, ::testing::AnyOf(ScanDirection::X, ScanDirection::Y));
  EXPECT_EQ(least.dof, 9.0) << "three powers along three directions";
}

TEST(GenericScan, FindsTheDifferenceOfTwoTemperatures) {
  std::mt19937_64 random(7);
  const LinearModel& model = model_of_nothing_hidden();
  const std::vector<ScanVariable> variables = two_temperatures();
  const Eigen::VectorXd difference = variables[0].value - variables[1].value;
  const std::vector<GenericTest> tests = scanned(
      white_residual(model, random) + 1e-6 * model.direction(ScanDirection::Z).cwiseProduct(difference),
      variables);
  const GenericTest& least = least_probable(tests);
  EXPECT_THAT(names_of(least.variables), ::testing::UnorderedElementsAre("T_air", "T_column"));
  EXPECT_EQ(least.direction, ScanDirection::Z);
}

/// What a test would explain, as one column, explains as much.
TEST(GenericScan, TellsWhatATestWouldExplain) {
  std::mt19937_64 random(6);
  const LinearModel& model = model_of_nothing_hidden();
  const Eigen::VectorXd moved = model.direction(ScanDirection::Y)
                                    .cwiseProduct(value_of_variable("T_column"))
                                    .cwiseProduct(value_of_variable("dir_x"));
  const Projector projector = white_projector(model, white_residual(model, random) + 0.8e-6 * moved);
  const std::vector<GenericTest> tests = generic_scan(model, variables_of_nothing_hidden(), projector, 1);
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    if (holds({tests[i]}, {"T_column", "dir_x"}, "Y")) chosen.push_back(i);
  }
  ASSERT_GE(chosen.size(), 4U) << "polynomials and kernels, along Y, several directions, rotations";
  const Eigen::MatrixXd explained =
      scanned_displacements(model, variables_of_nothing_hidden(), projector, tests, chosen);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const GenericTest& test = tests[chosen[k]];
    const auto column = static_cast<Eigen::Index>(k);
    const double lm = score_test(projector.project(explained.col(column)), 0, 1).lm;
    if (!test.kernel) {
      EXPECT_NEAR(lm, test.lm, 1e-6 * test.lm) << k;
    }
    if (test.rotation) continue;
    EXPECT_GT(lm, 50.0) << k;
    EXPECT_GT(explained.col(column).normalized().dot(moved.normalized()), 0.7) << k;
  }
}

}  // namespace
}  // namespace volcal
