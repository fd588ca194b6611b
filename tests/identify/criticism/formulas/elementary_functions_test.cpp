// The text of every function against its values: the expressions are read by muParser.

#include "volcal/identify/criticism/formulas/elementary_functions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "volcal/model/effects/kinds/open/custom.h"

namespace volcal {
namespace {

double by_expression(const std::string& text, const std::string& variable, double value,
                     const std::vector<double>& shape) {
  const Expression expression = custom_expression(text);
  Eigen::MatrixXd values(1, static_cast<Eigen::Index>(expression.variables().size()));
  for (std::size_t k = 0; k < expression.variables().size(); ++k) {
    const std::string& name = expression.variables()[k];
    values(0, static_cast<Eigen::Index>(k)) = name == variable ? value : name == "p" ? shape[0] : shape[1];
  }
  return expression.evaluate(values)[0];
}

TEST(ElementaryFunctions, AreWhatTheirExpressionsSay) {
  for (const auto& [variable, zero] : {std::pair{"y", 0.0}, {"y", -120.0}, {"T_column", 20.0}, {"t", 0.0}}) {
    const DriverRange driver{*Variable::parse_written(variable), 17.3, 260.0};
    for (const ElementaryFunction& function : elementary_functions(driver, zero)) {
      const std::string text = function.text({"p", "q"});
      ASSERT_FALSE(function.starts.empty()) << text;
      EXPECT_LE(function.shapes(), 2u) << text;
      for (const auto& start : function.starts) {
        ASSERT_EQ(start.size(), function.shapes()) << text;
        for (const double value : {18.1, 77.7, 133.0, 251.9}) {
          const double expected = by_expression(text, variable, value, start);
          EXPECT_NEAR(function.at(value, start), expected, 1e-12 * std::max(1.0, std::abs(expected))) << text;
        }
      }
    }
  }
}

/// In a unit that is a third as large all places and spans are three times as much, and the value is 3^power
/// times as much.
TEST(ElementaryFunctions, HaveThePowerOfTheirUnit) {
  constexpr double kSmaller = 3.0;
  const DriverRange driver{{Variable::Kind::Time}, 10.0, 3600.0};
  for (const ElementaryFunction& function : elementary_functions(driver, 0.0)) {
    const std::string text = function.text({"p", "q"});
    EXPECT_EQ(function.is_span.size(), function.shapes()) << text;
    for (std::vector<double> shape : function.starts) {
      const double value = 1234.5, before = function.at(value, shape);
      for (double& each : shape) each *= kSmaller;
      EXPECT_NEAR(function.at(kSmaller * value, shape), std::pow(kSmaller, function.power) * before,
                  1e-9 * std::abs(before))
          << text;
    }
  }
}

TEST(ElementaryFunctions, AreAllDifferent) {
  std::set<std::string> texts;
  for (const ElementaryFunction& function : elementary_functions({{Variable::Kind::Time}, 0.0, 3600.0}, 0.0))
    EXPECT_TRUE(texts.insert(function.text({"p", "q"})).second) << function.text({"p", "q"});
  EXPECT_EQ(texts.size(), 12u);
}

TEST(ElementaryFunctions, CountFromTheirZero) {
  const auto functions = elementary_functions({temperature_of("column"), 18.0, 26.0}, 20.0);
  EXPECT_EQ(functions.front().text({}), "(T_column - 20)");
  EXPECT_EQ(functions.front().at(20.0, {}), 0.0);
}

TEST(ElementaryFunctions, CountFromANegativePlaceByASum) {
  EXPECT_EQ(power_of(position_of(AxisName::Y), -250.0, 1).text({}), "(y + 250)");
  EXPECT_EQ(power_of(position_of(AxisName::Y), 120.0, 2).text({}), "(y - 120)^2");
  const DriverRange driver{position_of(AxisName::X), -300.0, 300.0};
  for (const ElementaryFunction& function : elementary_functions(driver, 0.0)) {
    const std::string text = function.text({"-40.5", "-7"});
    EXPECT_EQ(text.find("- -"), std::string::npos) << text;
    if (function.shapes() != 1 || text.find("40.5") == std::string::npos) continue;
    for (const double value : {-222.0, -40.0, 133.0}) {
      const double expected = by_expression(text, "x", value, {});
      EXPECT_NEAR(function.at(value, {-40.5}), expected, 1e-12 * std::max(1.0, std::abs(expected))) << text;
    }
  }
}

}  // namespace
}  // namespace volcal
