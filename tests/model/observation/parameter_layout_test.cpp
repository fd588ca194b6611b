#include <gtest/gtest.h>

#include "tests/support/machines.h"
#include "volcal/model/functions/registry.h"
#include "volcal/model/observation/parameters.h"

namespace volcal {
namespace {

constexpr ErrorSymbol kExx{Component::X, AxisName::X};
constexpr ErrorSymbol kEcx{Component::C, AxisName::X};
constexpr ErrorSymbol kEyy{Component::Y, AxisName::Y};

/// X: EXX and ECX share a linear spline of 3 coefficients; Y: EYY alone, 2 coefficients; one squareness.
ParameterLayout small_layout() {
  const Machine machine = testing_support::machine_of("w X' b Y Z t");
  const auto spline = [&](AxisName axis, int intervals) {
    FunctionSpec spec;
    spec.degree = 1;
    spec.breakpoints = uniform_breakpoints(machine.axis(axis), intervals);
    return std::shared_ptr<const Basis>(find_basis("bspline")->make(spec, machine.axis(axis)));
  };
  ParameterLayout layout;
  layout.groups.resize(2);
  layout.groups[0] = {AxisName::X, spline(AxisName::X, 2), {kExx, kEcx}, 0};
  layout.groups[1] = {AxisName::Y, spline(AxisName::Y, 1), {kEyy}, 6};
  ParameterBlock squareness;
  squareness.kind = ParameterKind::Location;
  squareness.name = "EC0Y";
  squareness.location = LocationSymbol{Component::C, AxisName::Y};
  squareness.offset = 8;
  squareness.guess = Eigen::VectorXd::Zero(1);
  layout.blocks.push_back(squareness);
  layout.function_size = 8;
  layout.size = 9;
  return layout;
}

TEST(ParameterLayout, FindsFunctionsBySymbol) {
  const ParameterLayout layout = small_layout();
  ASSERT_TRUE(layout.find(kEcx).has_value());
  EXPECT_EQ(layout.find(kEcx)->group, 0);
  EXPECT_EQ(layout.find(kEcx)->slot, 1);
  EXPECT_EQ(layout.find(kEyy)->group, 1);
  EXPECT_FALSE(layout.find({Component::A, AxisName::Z}).has_value());
  EXPECT_EQ(layout.symbols(), (std::vector<ErrorSymbol>{kExx, kEcx, kEyy}));
}

/// Coefficients of functions that share a basis are interleaved.
TEST(ParameterLayout, TakesCoefficientsOutOfTheVector) {
  const ParameterLayout layout = small_layout();
  const Eigen::VectorXd parameters = Eigen::VectorXd::LinSpaced(9, 0.0, 8.0);
  EXPECT_EQ(layout.coefficients(kExx, parameters), Eigen::Vector3d(0, 2, 4));
  EXPECT_EQ(layout.coefficients(kEcx, parameters), Eigen::Vector3d(1, 3, 5));
  EXPECT_EQ(layout.coefficients(kEyy, parameters), Eigen::Vector2d(6, 7));
  EXPECT_EQ(layout.coefficients({Component::A, AxisName::Z}, parameters).size(), 0);
}

TEST(ParameterLayout, FindsBlocksByNameAndLocation) {
  const ParameterLayout layout = small_layout();
  ASSERT_NE(layout.find_block("EC0Y"), nullptr);
  EXPECT_EQ(layout.find_block("EC0Y")->offset, 8);
  EXPECT_EQ(layout.find_location({Component::C, AxisName::Y}), layout.find_block("EC0Y"));
  EXPECT_EQ(layout.find_block("station P1"), nullptr);
  EXPECT_EQ(layout.find_location({Component::A, AxisName::Z}), nullptr);
}

/// A block's name may begin another's.
TEST(ParameterLayout, FindsParametersByTheirWholeNames) {
  ParameterLayout layout;
  for (const char* name : {"tool T1", "tool T10", "station P1"}) {
    ParameterBlock& block = layout.blocks.emplace_back();
    block.name = name;
    block.labels = {""};
    block.offset = static_cast<int>(layout.blocks.size());
  }
  layout.blocks.back().labels = {"x", "y"};
  EXPECT_EQ(layout.find_parameter("tool T1"), 1);
  EXPECT_EQ(layout.find_parameter("tool T10"), 2);
  EXPECT_EQ(layout.find_parameter("station P1 y"), 4);
  EXPECT_EQ(layout.find_parameter("tool T2"), std::nullopt);
  EXPECT_EQ(layout.find_parameter("station P1y"), std::nullopt);
}

}  // namespace
}  // namespace volcal
