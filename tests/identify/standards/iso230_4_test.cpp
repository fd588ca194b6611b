#include "volcal/identify/standards/iso230_4.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kRadius = 0.1;

void add_path(std::vector<CircleReading>& readings, int sense, double first_deg, double last_deg,
              double step_deg, const std::function<double(double)>& deviation_um) {
  const int count = static_cast<int>(std::lround(std::abs(last_deg - first_deg) / step_deg));
  for (int i = 0; i <= count; ++i) {
    const double degrees = first_deg + sense * i * step_deg;
    readings.push_back(
        {degrees * kRadianPerDegree, deviation_um(degrees * kRadianPerDegree) * kMicro, sense});
  }
}

/// By hand, um, eight readings each 45 degrees apart:
///   angle  0   45  90  135  180  225  270  315
///   CCW   +14  10  +6   10  +14   10   +6   10     = 10 + 4 cos 2a
///   CW    -1   -3  -5   -3   -1   -3   -5   -3     = -3 + 2 cos 2a
/// cos 2a is orthogonal to 1, cos a, sin a over the eight angles: the least-squares circles are centred, with
/// radius deviations 10 and -3.
/// G(CCW) = 14 - 6 = 8;  G(CW) = -1 - (-5) = 4;  F(CCW) = 14, 6;  F(CW) = -1, -5.
/// Both: D = (10 - 3) / 2 = 3.5; G(b) = 14 - (-5) = 19.
std::vector<CircleReading> hand_circle() {
  std::vector<CircleReading> readings;
  readings.reserve(16);
  const double ccw[] = {14, 10, 6, 10, 14, 10, 6, 10};
  const double cw[] = {-1, -3, -5, -3, -1, -3, -5, -3};
  for (int i = 0; i < 8; ++i) readings.push_back({45.0 * i * kRadianPerDegree, ccw[i] * kMicro, +1});
  for (int i = 7; i >= 0; --i) readings.push_back({45.0 * i * kRadianPerDegree, cw[i] * kMicro, -1});
  return readings;
}

/// The eight readings are 45 degrees apart, so F is about the instrument's centre; it is the same centre
/// here.
TEST(Iso230Part4, HandWorkedExample) {
  const CircularFigures figures = circular_figures(hand_circle(), kRadius);
  ASSERT_TRUE(figures.counter_clockwise && figures.clockwise);
  EXPECT_NEAR(figures.counter_clockwise->circular_deviation, 8e-6, 1e-12);
  EXPECT_NEAR(figures.clockwise->circular_deviation, 4e-6, 1e-12);
  EXPECT_NEAR(figures.counter_clockwise->radial_max, 14e-6, 1e-12);
  EXPECT_NEAR(figures.counter_clockwise->radial_min, 6e-6, 1e-12);
  EXPECT_NEAR(figures.clockwise->radial_max, -1e-6, 1e-12);
  EXPECT_NEAR(figures.clockwise->radial_min, -5e-6, 1e-12);
  EXPECT_NEAR(*figures.bidirectional, 19e-6, 1e-12);
  EXPECT_NEAR(*figures.mean_radial, 3.5e-6, 1e-12);
  EXPECT_NEAR(figures.counter_clockwise->largest_gap, 45.0 * kRadianPerDegree, 1e-12);
  EXPECT_EQ(figures.counter_clockwise->centring, Centring::Instrument);
}

/// A bar set up 1 mm and -0.5 mm off centre reads |R u - e|, whatever the machine does; with the machine
/// perfect all deviations but the centring vanish, to second order in the centring too (e^2 / 2R = 5 um
/// here).
TEST(Iso230Part4, CentringOfTheBarIsRemovedExactly) {
  const Eigen::Vector2d centre(1e-3, -0.5e-3);
  std::vector<CircleReading> readings;
  for (int i = 0; i < 72; ++i) {
    const double angle = 5.0 * i * kRadianPerDegree;
    const Eigen::Vector2d point = kRadius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    readings.push_back({angle, (point - centre).norm() - kRadius, +1});
  }
  const auto path = circular_figures(readings, kRadius).counter_clockwise;
  ASSERT_TRUE(path);
  EXPECT_NEAR(path->centre.x(), 1e-3, 1e-12);
  EXPECT_NEAR(path->centre.y(), -0.5e-3, 1e-12);
  EXPECT_LT(path->circular_deviation, 1e-13);
  EXPECT_LT(std::abs(path->radial_max), 1e-13);
  EXPECT_EQ(path->centring, Centring::LeastSquares);
}

/// A half circle keeps the instrument's centring: with the bar 10 um off along +first axis and known to be, F
/// is 0; taken as centred, F is -10 cos a: +10 at 180, -10 at 0 degrees.
TEST(Iso230Part4, PartialArcUsesTheInstrumentCentre) {
  std::vector<CircleReading> readings;
  add_path(readings, +1, 0, 180, 10, [](double angle) { return -10.0 * std::cos(angle); });
  const auto known = circular_figures(readings, kRadius, {10e-6, 0.0}).counter_clockwise;
  const auto assumed = circular_figures(readings, kRadius).counter_clockwise;
  ASSERT_TRUE(known && assumed);
  EXPECT_EQ(assumed->centring, Centring::Instrument);
  EXPECT_NEAR(known->radial_max, 0.0, 1e-9);  // (10 um)^2 / 2R = 0.5 nm of second order
  EXPECT_NEAR(assumed->radial_max, 10e-6, 1e-12);
  EXPECT_NEAR(assumed->radial_min, -10e-6, 1e-12);
  EXPECT_LT(assumed->circular_deviation, 1e-9);
}

/// Squareness g between the axes: x = R cos a, y = R sin a - ... the radius of the actual point
/// (R cos a - g R sin a, R sin a) is R - g R sin a cos a = R - (g R / 2) sin 2a. With g = 100 urad, R = 100
/// mm: an ellipse of +-5 um, largest at 135 and 315 degrees: G = 10 um in both senses, G(b) = 10 um, D = 0.
TEST(Iso230Part4, SquarenessIsAnEllipseOnTheDiagonals) {
  std::vector<CircleReading> readings;
  const auto ellipse = [](double angle) { return -5.0 * std::sin(2.0 * angle); };
  add_path(readings, +1, 0, 355, 5, ellipse);
  add_path(readings, -1, 355, 0, 5, ellipse);
  const CircularFigures figures = circular_figures(readings, kRadius);
  EXPECT_NEAR(figures.counter_clockwise->circular_deviation, 10e-6, 1e-12);
  EXPECT_NEAR(figures.clockwise->circular_deviation, 10e-6, 1e-12);
  EXPECT_NEAR(*figures.bidirectional, 10e-6, 1e-12);
  EXPECT_NEAR(*figures.mean_radial, 0.0, 1e-12);
  EXPECT_EQ(figures.counter_clockwise->centring, Centring::LeastSquares);
}

/// Lost motion of 6 um in the first axis: x+ = -3 (moving +), x- = +3 um, so B = -6. Counter-clockwise the
/// first axis moves + where sin a < 0. Radial: x cos a. Before 0 degrees -3 cos a, after it +3 cos a: an
/// outward step of 6; the second axis sees no step: at 90 degrees x cos a passes smoothly through 0.
TEST(Iso230Part4, LostMotionIsAStepWhereTheAxisTurnsRound) {
  std::vector<CircleReading> readings;
  const auto radial = [](int sense) {
    return [sense](double angle) {
      const bool moves_plus = sense * std::sin(angle) < 0.0;
      return (moves_plus ? -3.0 : 3.0) * std::cos(angle);
    };
  };
  add_path(readings, +1, -179.5, 179.5, 1, radial(+1));
  add_path(readings, -1, 179.5, -179.5, 1, radial(-1));
  const CircularFigures figures = circular_figures(readings, kRadius);
  ASSERT_EQ(figures.reversals.size(), 8U);
  for (const QuadrantReversal& reversal : figures.reversals) {
    const double expected = reversal.axis == 0 ? -6e-6 : 0.0;
    // cos a curves by less than 6 % within 20 degrees; both sides alike up to the sign: 2 x 3 x 1.1 %.
    EXPECT_NEAR(reversal.value, expected, 0.08e-6) << reversal.axis << ' ' << reversal.side;
  }
}

/// A perfect circle seen from 0.4 mm and -0.3 mm beside it: about that centre nothing deviates, and both ways
/// round are drawn about it. About the nominal one the radius deviates by -0.4 cos a + 0.3 sin a mm to first
/// order, at 0 degrees by hypot(100 - 0.4, 0.3) - 100 mm.
TEST(Iso230Part4, BothWaysAreDrawnAboutTheCentreOfTheReadings) {
  const Eigen::Vector2d centre(0.4e-3, -0.3e-3);
  const auto seen = [&](double angle) {
    return ((kRadius * Eigen::Vector2d(std::cos(angle), std::sin(angle)) - centre).norm() - kRadius) / kMicro;
  };
  std::vector<CircleReading> readings;
  add_path(readings, +1, 0, 355, 5, seen);
  add_path(readings, -1, 355, 0, 5, seen);
  const CircularFigures figures = circular_figures(readings, kRadius);
  EXPECT_EQ(figures.centring, Centring::LeastSquares);
  EXPECT_LT((figures.centre - centre).norm(), 1e-12);
  for (const CircleReading& reading : radial_deviations(readings, kRadius, figures.centre))
    EXPECT_NEAR(reading.deviation, 0.0, 1e-12);
  const auto about_nominal = radial_deviations(readings, kRadius, Eigen::Vector2d::Zero());
  EXPECT_NEAR(about_nominal[0].deviation, std::hypot(99.6e-3, 0.3e-3) - 100e-3, 1e-12);
  EXPECT_EQ(about_nominal[0].sense, +1);
}

/// Half a circle does not say where its centre is.
TEST(Iso230Part4, PartOfACircleIsDrawnAboutTheInstrumentsCentre) {
  std::vector<CircleReading> readings;
  add_path(readings, +1, 0, 180, 5, [](double) { return 1.0; });
  const Eigen::Vector2d instrument(1e-6, 2e-6);
  const CircularFigures figures = circular_figures(readings, kRadius, instrument);
  EXPECT_EQ(figures.centring, Centring::Instrument);
  EXPECT_EQ(figures.centre, instrument);
}

TEST(Iso230Part4, TooFewReadingsLeaveThePathEmpty) {
  const std::vector<CircleReading> readings = {{0.0, 0.0, +1}, {1.0, 0.0, +1}, {2.0, 0.0, +1}};
  const CircularFigures figures = circular_figures(readings, kRadius);
  EXPECT_FALSE(figures.counter_clockwise.has_value());
  EXPECT_FALSE(figures.clockwise.has_value());
  EXPECT_FALSE(figures.bidirectional.has_value());
  EXPECT_TRUE(figures.reversals.empty());
}

}  // namespace
}  // namespace volcal
