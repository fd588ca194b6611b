// The error over the positions of rotary axes: hand-worked points, and exact transforms.

#include "volcal/identify/errors/rotary/rotary_map.h"

#include <gtest/gtest.h>

#include "tests/support/rotary_machines.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using Eigen::Vector3d;

constexpr double kQuarter = std::numbers::pi / 2.0;

/// A table axis C alone; the tool point of a tool without length at (0, 100, 50) mm of the workpiece.
RotaryMapNode at_a_quarter_turn(const testing::GivenErrors& given) {
  Machine machine = testing_support::machine_of("w C' b X Y Z t");
  machine.axes.front().travel_min = -std::numbers::pi;
  machine.axes.front().travel_max = std::numbers::pi;
  machine.axes.front().centre = Vector3d::Zero();
  machine.tools = {{"probe", Vector3d::Zero(), 0.0}};
  FitResult result = testing::result_with(machine, given, 4);
  result.covariance = 1e-12 * Eigen::MatrixXd::Identity(result.layout.size, result.layout.size);
  const RotaryMap map =
      rotary_map(result, machine.tools[0], {0.0, 0.1, 0.05}, default_conditions(result), kQuarter);
  EXPECT_EQ(map.axes.size(), 1u);
  EXPECT_NEAR(map.axes.at(0).positions.at(3), kQuarter, 1e-12);
  return map.nodes.at(3);
}

testing::GivenErrors constant(const std::string& symbol, double value) {
  return {.functions = {{symbol, [value](double) { return value; }}}};
}

/// X = 100, Z = 50 mm at C = 90 degrees; 10 um or 100 urad.
TEST(RotaryMap, OfATableByHand) {
  const auto displaced = [](const testing::GivenErrors& given) {
    return Vector3d(at_a_quarter_turn(given).value.head<3>() * 1e6);
  };
  EXPECT_LT((displaced(constant("EXC", 10e-6)) - Vector3d(0, 10, 0)).norm(), 1e-9);
  EXPECT_LT((displaced(constant("EAC", 100e-6)) - Vector3d(5, 0, 0)).norm(), 1e-9);
  EXPECT_LT((displaced(constant("EBC", 100e-6)) - Vector3d(0, 5, -10)).norm(), 1e-9);
  EXPECT_LT((displaced(constant("ECC", 100e-6)) - Vector3d(-10, 0, 0)).norm(), 1e-9);
  EXPECT_LT((displaced({.locations = {{"EX0C", 10e-6}}}) - Vector3d(0, -10, 0)).norm(), 1e-9);
  EXPECT_LT((displaced({.locations = {{"EB0C", 100e-6}}}) - Vector3d(0, -5, 10)).norm(), 1e-9);
}

/// u of EB0C is 1 urad: 0.05 um along y and 0.1 um along z, in the direction of the error itself the root sum
/// of their squares; the tool's axis turns by the tilt, and a rotation about it does not count.
TEST(RotaryMap, StatesUncertaintyAndTheDirectionOfTheTool) {
  const RotaryMapNode tilted = at_a_quarter_turn({.locations = {{"EB0C", 100e-6}}});
  EXPECT_NEAR(tilted.size * 1e6, std::hypot(5.0, 10.0), 1e-9);
  EXPECT_NEAR(tilted.u[1] * 1e6, 0.05, 1e-9);
  EXPECT_NEAR(tilted.u[2] * 1e6, 0.1, 1e-9);
  EXPECT_NEAR(tilted.u_size * 1e6, std::hypot(0.05, 0.1), 1e-9);
  EXPECT_NEAR(tilted.tool_axis * 1e6, 100.0, 1e-9);
  EXPECT_NEAR(tilted.u_tool_axis * 1e6, 1.0, 1e-9);
  EXPECT_FALSE(tilted.extrapolated);
  const RotaryMapNode turned = at_a_quarter_turn(constant("ECC", 100e-6));
  EXPECT_NEAR(turned.value[5] * 1e6, 100.0, 1e-9);
  EXPECT_NEAR(turned.tool_axis, 0.0, 1e-15);
}

/// Where the tool of a trunnion stands, by rotation matrices of the test's own: the table carries the point,
/// the linear axes bring the tool there.
TEST(RotaryMap, OfATrunnionIsThatOfExactTransforms) {
  const FitResult result = testing::rotary_result(testing::kTrunnion);
  const Machine& machine = result.machine;
  const Tool& tool = machine.tools.front();
  const Vector3d point_w(0.08, -0.05, -0.15);
  const RotaryMap map =
      rotary_map(result, tool, point_w, default_conditions(result), 20.0 * kRadianPerDegree);
  ASSERT_EQ(map.axes.size(), 2u);
  EXPECT_EQ(map.nodes.size(), map.axes[0].positions.size() * map.axes[1].positions.size());
  const KinematicChain chain(machine);
  const ErrorField field(result, tool);
  const auto turned = [](const Vector3d& point, const Vector3d& centre, int about, double angle) {
    return Vector3d(rotation_about<double>(about, angle) * (point - centre) + centre);
  };
  std::size_t n = 0;
  double largest = 0.0;
  for (const double a : map.axes[0].positions) {
    for (const double c : map.axes[1].positions) {
      Vector3d machine_point = turned(point_w, machine.axis(AxisName::C).centre, 2, -c);
      machine_point = turned(machine_point, machine.axis(AxisName::A).centre, 0, -a);
      const Vector3d linear = machine_point - tool.offset;
      AxisPosition position{linear.x(), linear.y(), linear.z()};
      position[index_of(AxisName::A)] = a;
      position[index_of(AxisName::C)] = c;
      ASSERT_LT((chain.nominal_point_w(position, tool.offset) - point_w).norm(), 1e-12);
      const Vector3d exact =
          chain.exact_pose<double>(position, tool.offset, field.joint_errors(position)).point_w - point_w;
      EXPECT_LT((map.nodes[n].value.head<3>() - exact).norm(), 20e-9);
      largest = std::max(largest, exact.norm());
      ++n;
    }
  }
  EXPECT_GT(largest, 10e-6);
}

TEST(RotaryMap, OfAHeadFollowsWithTheTool) {
  const FitResult result = testing::rotary_result(testing::kHead);
  const Vector3d point_w = middle_point_w(result.machine, result.machine.tools[0]);
  EXPECT_LT((point_w - Vector3d(0, 0, -0.2)).norm(), 1e-15);
  const RotaryMap map =
      rotary_map(result, result.machine.tools[1], point_w, default_conditions(result), 30 * kRadianPerDegree);
  EXPECT_EQ(map.tool, "long");
  const ErrorField field(result, result.machine.tools[1]);
  const auto& b = map.axes[0].positions;
  const auto& c = map.axes[1].positions;
  for (std::size_t i = 0; i < b.size(); ++i) {
    for (std::size_t k = 0; k < c.size(); ++k) {
      AxisPosition position{};  // a head's errors do not depend on where its linear axes stand
      position[index_of(AxisName::B)] = b[i];
      position[index_of(AxisName::C)] = c[k];
      const PoseErrorVector expected = field.at(position);
      EXPECT_LT((map.nodes[i * c.size() + k].value - expected).cwiseAbs().maxCoeff(), 1e-15);
    }
  }
}

TEST(RotaryMap, NeedsIdentifiedRotaryAxes) {
  const Machine machine = testing::rotary_machine(testing::kTrunnion);
  const FitResult result = testing::result_with(machine, {.locations = {{"EC0Y", 1e-6}}}, 1);
  EXPECT_THROW(rotary_map(result, machine.tools[0], Vector3d::Zero(), default_conditions(result), 0.1),
               InputError);
}

}  // namespace
}  // namespace volcal
