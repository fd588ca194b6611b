// Error motion values of ISO 230-7 by hand.

#include "volcal/identify/standards/iso230_7.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace volcal {
namespace {

constexpr double kTwelfthOfATurn = std::numbers::pi / 6.0;  // twelve places a turn

std::vector<RotationReading> turns(int count, const std::function<double(int, double)>& value) {
  std::vector<RotationReading> readings;
  for (int turn = 0; turn < count; ++turn) {
    for (int k = 0; k < 12; ++k) {
      const double angle = turn * 2.0 * std::numbers::pi + k * kTwelfthOfATurn;
      readings.push_back({angle, value(turn, angle) * 1e-6});
    }
  }
  return readings;
}

/// 5 + 3 cos + 4 sin + 2 cos 2: about the least-squares centre 2 cos 2 is left, from -2 to 2; the amplitude
/// at one wave a turn is 5.
TEST(ErrorMotion, AboutTheLeastSquaresCentreHasNoEccentricity) {
  const auto readings = turns(
      1, [](int, double q) { return 5.0 + 3.0 * std::cos(q) + 4.0 * std::sin(q) + 2.0 * std::cos(2.0 * q); });
  const ErrorMotionFigures figures = error_motion_figures(readings, MotionCentre::LeastSquares);
  EXPECT_EQ(figures.angles, 12);
  EXPECT_NEAR(*figures.total * 1e6, 4.0, 1e-9);
  EXPECT_NEAR(*figures.synchronous * 1e6, 4.0, 1e-9);
  EXPECT_NEAR(*figures.fundamental * 1e6, 10.0, 1e-9);
  EXPECT_FALSE(figures.asynchronous) << "no angle was met twice";
}

/// 3 sin about the centre of the chart: from -3 to 3, all of it at one wave a turn.
TEST(ErrorMotion, AboutThePolarChartKeepsOneWaveATurn) {
  const auto readings = turns(1, [](int, double q) { return 7.0 + 3.0 * std::sin(q); });
  const ErrorMotionFigures axial = error_motion_figures(readings, MotionCentre::PolarChart);
  EXPECT_NEAR(*axial.total * 1e6, 6.0, 1e-9);
  EXPECT_NEAR(*axial.fundamental * 1e6, 6.0, 1e-9);
  EXPECT_NEAR(*error_motion_figures(readings, MotionCentre::LeastSquares).total * 1e6, 0.0, 1e-9);
}

/// 1 um in the second of two turns at 90 degrees alone: width 1 there, 0.5 in the mean. Its least-squares
/// constant is 0.5 / 12, its first harmonic (1 / 12) cos(q - 90): left is 0.5 - 0.5/12 - 1/12 at 90 degrees
/// and at the least, 30 degrees beside it, -0.5/12 - cos(30)/12. Of all readings the largest is 1 there, the
/// least -0.5/12 - 1/12 in the first turn.
TEST(ErrorMotion, TellsTurnsThatDiffer) {
  const auto readings = turns(2, [](int turn, double q) {
    return turn == 1 && std::abs(q - 2.5 * std::numbers::pi) < 1e-9 ? 1.0 : 0.0;
  });
  const ErrorMotionFigures figures = error_motion_figures(readings, MotionCentre::LeastSquares);
  EXPECT_EQ(figures.angles, 12);
  EXPECT_NEAR(*figures.asynchronous * 1e6, 1.0, 1e-9);
  EXPECT_NEAR(*figures.synchronous * 1e6, 0.5 - 1.0 / 12.0 + std::cos(kTwelfthOfATurn) / 12.0, 1e-9);
  EXPECT_NEAR(*figures.total * 1e6, 1.0, 1e-9);
}

TEST(ErrorMotion, NeedsAFullTurn) {
  std::vector<RotationReading> half;
  for (int k = 0; k <= 6; ++k) half.push_back({k * kTwelfthOfATurn, 1e-6 * k});
  const ErrorMotionFigures figures = error_motion_figures(half, MotionCentre::LeastSquares);
  EXPECT_EQ(figures.angles, 7);
  EXPECT_NEAR(figures.largest_gap, std::numbers::pi, 1e-12);
  EXPECT_FALSE(figures.total);
  EXPECT_FALSE(figures.fundamental);
  EXPECT_FALSE(error_motion_figures({}, MotionCentre::LeastSquares).total);
}

/// 0 and 360 degrees are one angle, and so is what rounding leaves below a turn.
TEST(ErrorMotion, CountsAnglesModuloATurn) {
  const std::vector<RotationReading> readings = {
      {-2.0 * std::numbers::pi - 1e-13, 1e-6}, {0.0, 2e-6}, {2.0 * std::numbers::pi, 4e-6}};
  const ErrorMotionFigures figures = error_motion_figures(readings, MotionCentre::PolarChart);
  EXPECT_EQ(figures.angles, 1);
}

}  // namespace
}  // namespace volcal
