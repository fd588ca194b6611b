// Programs as a control runs them: expected numbers by hand, beside each.

#include "volcal/identify/program/nc_interpreter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/nc_programs.h"

namespace volcal {
namespace {

using testing::motions_of;
using testing::simple_setup;

constexpr double kPi = std::numbers::pi;

void expect_point(const Eigen::Vector3d& actual, double x_mm, double y_mm, double z_mm) {
  EXPECT_NEAR(actual.x(), x_mm * 1e-3, 1e-12);
  EXPECT_NEAR(actual.y(), y_mm * 1e-3, 1e-12);
  EXPECT_NEAR(actual.z(), z_mm * 1e-3, 1e-12);
}

/// End of the last motion.
Eigen::Vector3d end_of(const std::string& program, const NcSetup& setup = simple_setup()) {
  return motions_of(program, setup).back().to;
}

TEST(NcInterpreter, ReadsWordsInAnyCaseWithCommentsAndBlanks) {
  expect_point(end_of("/ (none)\nn10 g00 x 1.5 (up) Y-.25 z+2. ; end\n"), 1.5, -0.25, 2.0);
}

TEST(NcInterpreter, AddsIncrementsUnderG91) {
  expect_point(end_of("G0 X10 Y5\nG91 X1 Y-2\nX1\nG90 Z3\n"), 12.0, 3.0, 3.0);
}

TEST(NcInterpreter, ConvertsInches) { expect_point(end_of("G20 G0 X1 Y0.5\nG21 Z3\n"), 25.4, 12.7, 3.0); }

/// Axis = program + work offset + G92 + tool length; changing an offset moves nothing.
TEST(NcInterpreter, AddsOffsets) {
  NcSetup setup = simple_setup();
  setup.work_offsets[1] = Eigen::Vector3d(0.1, 0.2, -0.3);
  setup.tool_lengths[7] = 0.05;
  expect_point(end_of("G55 G0 X1 Y2 Z3\n", setup), 101.0, 202.0, -297.0);
  expect_point(end_of("G0 X1 Y2 Z3\nG43 H7 X4\n", setup), 4.0, 2.0, 3.0);
  expect_point(end_of("G43 H7 G0 Z10\n", setup), 0.0, 0.0, 60.0);
  expect_point(end_of("G43 H7\nG49 G0 Z10\n", setup), 0.0, 0.0, 10.0);
  expect_point(end_of("G43.1 X1 Z5\nG0 X0 Z10\n", setup), 1.0, 0.0, 15.0);
  expect_point(end_of("G0 X5\nG92 X1\nG0 X2\n", setup), 6.0, 0.0, 0.0);
  expect_point(end_of("G0 X5\nG92 X1\nG92.2\nG0 X2\n", setup), 2.0, 0.0, 0.0);
  expect_point(end_of("G0 X5\nG92 X1\nG92.2\nG92.3 G0 X2\n", setup), 6.0, 0.0, 0.0);
  expect_point(end_of("G0 X5\nG92 X1\nG92.1 G0 X2\n", setup), 2.0, 0.0, 0.0);
  expect_point(end_of("G52 X5\nG0 X1\nG52 X0\nG0 Y1\n", setup), 6.0, 1.0, 0.0);
  expect_point(end_of("G10 L2 P3 X1 Y2 Z3\nG56 G0 X0 Y0 Z0\n", setup), 1.0, 2.0, 3.0);
  expect_point(end_of("G55 G43 H7 G0 Z1\nG91 G53 G0 Z0 X3\n", setup), 3.0, 0.0, 0.0);
}

/// Middle points of quarter circles in each plane: start + radius (sin 45, 1 - cos 45) in the directions of
/// the plane.
TEST(NcInterpreter, RunsArcsInThreePlanes) {
  const double s = 10.0 * std::sin(kPi / 4), c = 10.0 - 10.0 * std::cos(kPi / 4);
  // G17: start 0,0, centre 0,10: counter-clockwise goes towards +X.
  expect_point(motions_of("F100 G3 X10 Y10 J10\n")[0].point(0.5), s, c, 0.0);
  // G18 turns Z towards X: centre at X 10, counter-clockwise goes towards +Z.
  expect_point(motions_of("F100 G18 G3 Z10 X10 I10\n")[0].point(0.5), c, 0.0, s);
  // G19 turns Y towards Z: centre at Z 10, counter-clockwise goes towards +Y.
  expect_point(motions_of("F100 G19 G3 Y10 Z10 K10\n")[0].point(0.5), 0.0, s, c);
  // Clockwise the same end is reached the long way, 270 degrees.
  EXPECT_NEAR(motions_of("F100 G2 X10 Y10 J10\n")[0].length(), 15e-3 * kPi, 1e-12);
}

TEST(NcInterpreter, RunsHelicesFullCirclesAndTurns) {
  // One turn of radius 5 that rises 3: sqrt((10 pi)^2 + 9).
  const NcMotion helix = motions_of("F100 G2 Z3 I5\n")[0];
  EXPECT_NEAR(helix.length(), 1e-3 * std::hypot(10 * kPi, 3.0), 1e-12);
  expect_point(helix.point(0.25), 5.0, 5.0, 0.75);
  EXPECT_NEAR(motions_of("F100 G2 X0 Y0 I5 P3\n")[0].length(), 30e-3 * kPi, 1e-12);
  // Centre at (5, 0) in absolute coordinates.
  expect_point(motions_of("F100 G90.1 G2 X10 Y0 I5 J0\n")[0].point(0.5), 5.0, 5.0, 0.0);
}

TEST(NcInterpreter, FindsTheCentreOfAnArcWithR) {
  // Quarter circle with centre (0, 10); with -R the other three quarters about (10, 0).
  expect_point(motions_of("F100 G3 X10 Y10 R10\n")[0].point(0.5), 10 * std::sin(kPi / 4),
               10 - 10 * std::cos(kPi / 4), 0.0);
  const NcMotion longer = motions_of("F100 G3 X10 Y10 R-10\n")[0];
  EXPECT_NEAR(longer.length(), 15e-3 * kPi, 1e-12);
  EXPECT_NEAR(longer.arc.centre.x(), 10e-3, 1e-12);
  EXPECT_NEAR(longer.arc.centre.y(), 0.0, 1e-12);
}

/// 60 mm at 600 mm/min is 6 s; F 4 under G93 is a quarter of a minute; 0.1 mm a turn at 1200/min is 120
/// mm/min.
TEST(NcInterpreter, KeepsTime) {
  EXPECT_NEAR(motions_of("G1 X60 F600\n")[0].duration, 6.0, 1e-12);
  EXPECT_NEAR(motions_of("G20\nG1 X10 F60\n")[0].duration, 10.0, 1e-12);
  EXPECT_NEAR(motions_of("G93 G1 X60 F4\n")[0].duration, 15.0, 1e-12);
  EXPECT_NEAR(motions_of("G95 S1200 G1 X60 F0.1\n")[0].duration, 30.0, 1e-12);
  EXPECT_TRUE(std::isnan(motions_of("G95 G1 X60 F0.1\n")[0].duration));
}

TEST(NcInterpreter, ExpandsDrillingCycles) {
  // From Z 10 over to the hole, to R, to the bottom, and back to where it began (G98).
  const auto g81 = motions_of("G98 G0 Z10\nG81 X5 Y6 Z-3 R2 F60\nX7\n");
  ASSERT_EQ(g81.size(), 9U);
  expect_point(g81[1].to, 5.0, 6.0, 10.0);
  expect_point(g81[2].to, 5.0, 6.0, 2.0);
  expect_point(g81[3].to, 5.0, 6.0, -3.0);
  EXPECT_EQ(g81[3].kind, NcMotionKind::Feed);
  EXPECT_NEAR(g81[3].duration, 5.0, 1e-12);
  expect_point(g81[4].to, 5.0, 6.0, 10.0);
  expect_point(g81[7].to, 7.0, 6.0, -3.0);
  // G99 stays at R; increments repeat.
  const auto rows = motions_of("G0 Z10\nG91 G99 G82 X5 Z-3 R-8 P0.5 L2 F60\n");
  ASSERT_EQ(rows.size(), 10U);
  expect_point(rows[3].to, 5.0, 0.0, -1.0);
  EXPECT_EQ(rows[4].kind, NcMotionKind::Dwell);
  expect_point(rows.back().to, 10.0, 0.0, 2.0);
}

TEST(NcInterpreter, PecksInG83AndG73) {
  // R 2 to -3 in pecks of 2: 0, -2, -3, each time up to R and back to 0.254 above the last depth.
  const auto full = motions_of("G0 X5 Z2\nG83 X5 Z-3 R2 Q2 F60\n");
  ASSERT_EQ(full.size(), 9U);
  expect_point(full[1].to, 5.0, 0.0, 0.0);
  expect_point(full[2].to, 5.0, 0.0, 2.0);
  expect_point(full[3].to, 5.0, 0.0, 0.254);
  expect_point(full[4].to, 5.0, 0.0, -2.0);
  expect_point(full[7].to, 5.0, 0.0, -3.0);
  const auto chips = motions_of("G0 X5 Z2\nG73 X5 Z-3 R2 Q2 F60\n");
  ASSERT_EQ(chips.size(), 7U);
  expect_point(chips[2].to, 5.0, 0.0, 0.254);
}

TEST(NcInterpreter, EndsAtM2AndAtTheSecondPercent) {
  EXPECT_EQ(motions_of("%\nG0 X1\n%\nG0 X2 #1=2\n").size(), 1U);
  EXPECT_EQ(motions_of("G0 X1\nG0 X2 M2\nwhatever\n").size(), 2U);
}

TEST(NcInterpreter, ObeysTheBlockDeleteSwitch) {
  NcSetup setup = simple_setup();
  setup.block_delete = true;
  EXPECT_TRUE(motions_of("/G0 X1\n", setup).empty());
  setup.block_delete = false;
  EXPECT_EQ(motions_of("/G0 X1\n", setup).size(), 1U);
}

TEST(NcInterpreter, BeginsWithoutKnowingWhereTheAxesAre) {
  NcSetup setup = simple_setup();
  setup.start.reset();
  EXPECT_EQ(motions_of("G0 X1 Y1\nG0 Z1\nG1 X2 F10\n", setup).size(), 3U);
}

}  // namespace
}  // namespace volcal
