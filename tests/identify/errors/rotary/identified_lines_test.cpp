// Lines of rotary axes with their uncertainty, by hand.

#include "volcal/identify/errors/rotary/identified_lines.h"

#include <gtest/gtest.h>

#include "tests/support/rotary_machines.h"

namespace volcal {
namespace {

using Eigen::Vector2d;

/// p_C = 0, p_A = (0, 0, 50) mm; 1 um and 1 urad of standard uncertainty of every location error.
FitResult trunnion_lines() {
  Machine machine = testing_support::machine_of(testing::kTrunnion);
  machine.axes[1].centre = {0.0, 0.0, 0.05};
  FitResult result = testing::result_with(machine,
                                          {.locations = {{"EY0A", 10e-6},
                                                         {"EZ0A", -20e-6},
                                                         {"EB0A", 60e-6},
                                                         {"EC0A", -40e-6},
                                                         {"EX0C", 5e-6},
                                                         {"EY0C", 7e-6},
                                                         {"EA0C", 30e-6},
                                                         {"EB0C", -20e-6}}},
                                          1);
  result.covariance = 1e-12 * Eigen::MatrixXd::Identity(8, 8);
  return result;
}

/// d = (5 - 0.05 x 60, 7 + 10) um, alpha = (30, -20 + 60) urad; 100 mm along C the line is off by
/// 0.1 x (40, -30) um more.
TEST(IdentifiedLines, AreThoseAtMachineZero) {
  const auto lines = identified_lines(trunnion_lines());
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].axis, AxisName::A);
  EXPECT_EQ(lines[1].axis, AxisName::C);
  const IdentifiedLine& c = lines[1];
  EXPECT_LT((c.value.displacement.head<2>() - Vector2d(2e-6, 17e-6)).norm(), 1e-15);
  EXPECT_LT((c.value.rotation.head<2>() - Vector2d(30e-6, 40e-6)).norm(), 1e-15);
  EXPECT_LT((c.displacement_at(0.1).head<2>() - Vector2d(6e-6, 14e-6)).norm(), 1e-15);
}

/// u^2(x) = 1 + 0.05^2, u^2(y) = 1 + 1, of the tilts 1 and 1 + 1; x and the tilt about y share EB0A:
/// covariance -0.05. 100 mm along C: x gains 0.1 of that tilt, 1.0025 + 0.02 - 2 x 0.1 x 0.05.
TEST(IdentifiedLines, CarryTheUncertaintyOfTheCarryingAxes) {
  const IdentifiedLine c = identified_lines(trunnion_lines())[1];
  const auto covariance = [&](int i, int j) { return c.covariance(i, j) * 1e12; };
  EXPECT_NEAR(covariance(0, 0), 1.0025, 1e-9);
  EXPECT_NEAR(covariance(1, 1), 2.0, 1e-9);
  EXPECT_NEAR(covariance(3, 3), 1.0, 1e-9);
  EXPECT_NEAR(covariance(4, 4), 2.0, 1e-9);
  EXPECT_NEAR(covariance(0, 4), -0.05, 1e-9);
  EXPECT_NEAR(c.covariance_at(0.1)(0, 0) * 1e12, 1.0025 + 0.02 - 0.01, 1e-9);
}

/// The line of A has no displacement along A and no tilt about it; that of C none along C, but a turn about
/// it through EC0A. A head C that carries B has no displacement of its own, and nothing carries it.
TEST(IdentifiedLines, TellWhatIsZeroByConvention) {
  const auto lines = identified_lines(trunnion_lines());
  EXPECT_EQ(lines[0].by_convention, (std::array{true, false, false, true, false, false}));
  EXPECT_FALSE(lines[1].by_convention[0]);
  EXPECT_FALSE(lines[1].by_convention[1]);
  const FitResult head =
      testing::result_with(testing_support::machine_of(testing::kHead),
                           {.locations = {{"EA0C", 1e-6}, {"EB0C", 2e-6}, {"EX0B", 3e-6}}}, 1);
  for (const IdentifiedLine& line : identified_lines(head)) {
    if (line.axis != AxisName::C) continue;
    EXPECT_EQ(line.by_convention, (std::array{true, true, true, false, false, true}));
  }
}

TEST(IdentifiedLines, AreNoneWithoutLocationErrors) {
  const Machine machine = testing::rotary_machine(testing::kTrunnion);
  EXPECT_TRUE(identified_lines(testing::result_with(machine, {.locations = {{"EC0Y", 1e-6}}}, 1)).empty());
}

}  // namespace
}  // namespace volcal
