#include "volcal/identify/standards/standard_figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/residual_records.h"
#include "volcal/identify/standards/test_paths.h"
#include "volcal/identify/words/sentences.h"

namespace volcal {
namespace {

using testing::records_of;

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Campaign empty_campaign() {
  Campaign campaign;
  campaign.machine.name = "test";
  campaign.machine.structure = Structure::parse("w X' Y' b Z t");
  for (const AxisName name : {AxisName::X, AxisName::Y, AxisName::Z}) {
    Axis axis;
    axis.name = name;
    axis.travel_max = 1.0;
    campaign.machine.axes.push_back(axis);
  }
  campaign.machine.tools = {{"probe", Vector3d(0.01, -0.02, -0.1), 0.0}};
  return campaign;
}

/// Points in m; `value` in SI per channel.
struct Point {
  Vector3d at;
  double value = 0.0;
  int line = 0;
};

Setup& add_setup(Campaign& campaign, const std::string& name, const std::string& instrument,
                 const std::vector<Point>& points) {
  Setup setup;
  setup.name = name;
  setup.instrument = instrument;
  setup.readings.value.resize(1);
  for (std::size_t k = 0; k < points.size(); ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      setup.readings.position[axis].push_back(points[k].at[static_cast<int>(axis)]);
    }
    setup.readings.value[0].push_back(points[k].value);
    setup.readings.line.push_back(points[k].line);
    setup.readings.source_line.push_back(static_cast<std::int64_t>(k) + 2);
  }
  campaign.setups.push_back(std::move(setup));
  return campaign.setups.back();
}

/// Displacement along X from 0.1 to 0.3 and back, twice; deviations in um by hand:
///   target   +        -       mean+  mean-  B
///   0.1      0, 2     3, 5    1      4      -3
///   0.2      5, 5     4, 6    5      5      0
///   0.3      8, 10    7, 7    9      7      +2
/// E = 9 - 1 = 8; B = 3; mean reversal = -1/3; M = 8 - 2.5 = 5.5. s: sqrt 2, 0, sqrt 2 (+); sqrt 2, sqrt 2, 0
/// (-). R_1 = 2 sqrt 2 + 2 sqrt 2 + 3 = 8.657; R_2 = max(2 sqrt 2, 4 sqrt 2) = 5.657; R_3 = 2 sqrt 2 + 2
/// = 4.828 or 4 sqrt 2 = 5.657: R = 4 sqrt 2 + 3. A: highest 9 + 2 sqrt 2, lowest 1 - 2 sqrt 2: 8 + 4 sqrt 2.
std::vector<Point> x_line(double y, double zero, int sign) {
  const double target[] = {0.1, 0.2, 0.3, 0.3, 0.2, 0.1};
  const double deviation_um[][6] = {{0, 5, 8, 7, 4, 3}, {2, 5, 10, 7, 6, 5}};
  std::vector<Point> points;
  for (int run = 0; run < 2; ++run) {
    for (int k = 0; k < 6; ++k) {
      const double displacement = target[k] - 0.1 + deviation_um[run][k] * 1e-6;
      points.push_back({Vector3d(target[k], y, 0.4), zero + sign * displacement, 2 * run + (k < 3 ? 0 : 1)});
    }
  }
  return points;
}

void expect_x_line(const PositioningFigures& figures) {
  ASSERT_EQ(figures.targets.size(), 3U);
  EXPECT_NEAR(figures.targets[1].position, 0.2, 1e-12);
  EXPECT_NEAR(*figures.systematic, 8e-6, 1e-12);
  EXPECT_NEAR(*figures.reversal, 3e-6, 1e-12);
  EXPECT_NEAR(*figures.mean_reversal, -1e-6 / 3.0, 1e-12);
  EXPECT_NEAR(*figures.mean_bidirectional, 5.5e-6, 1e-12);
  EXPECT_NEAR(*figures.repeatability, (4.0 * std::sqrt(2.0) + 3.0) * 1e-6, 1e-12);
  EXPECT_NEAR(*figures.accuracy, (8.0 + 4.0 * std::sqrt(2.0)) * 1e-6, 1e-12);
}

TEST(StandardFigures, DisplacementAlongOneAxisIsAnIso230Part2Line) {
  Campaign campaign = empty_campaign();
  add_setup(campaign, "line_X", "displacement", x_line(0.5, 123e-6, +1))
      .options.set("direction", Vector3d(1, 0, 0));
  const auto figures = standard_figures(campaign, records_of(campaign, [&](auto s, auto row, double) {
                                          return campaign.setups[s].readings.position[0][row] * (1.0 + 50e-6);
                                        }));
  ASSERT_EQ(figures.lines.size(), 1U);
  EXPECT_THAT(figures.not_recognised, IsEmpty());
  const AxisLineTest& line = figures.lines[0];
  EXPECT_EQ(line.axis, AxisName::X);
  EXPECT_EQ(line.place, "Y 500, Z 400 mm");
  expect_x_line(line.figures.readings);
  // The model stretches X by 50 um/m: E = 50 um/m x 0.2 m = 10 um, no reversal, no spread.
  EXPECT_NEAR(*line.figures.model.systematic, 10e-6, 1e-12);
  EXPECT_NEAR(*line.figures.model.reversal, 0.0, 1e-12);
  EXPECT_NEAR(*line.figures.model.repeatability, 0.0, 1e-12);
}

TEST(StandardFigures, BeamAgainstTheAxisCountsDeviationsAlongTheAxis) {
  Campaign campaign = empty_campaign();
  add_setup(campaign, "line_X", "displacement", x_line(0.5, 0.0, -1))
      .options.set("direction", Vector3d(-1, 0, 0));
  const auto figures =
      standard_figures(campaign, records_of(campaign, [](auto, auto, double reading) { return reading; }));
  ASSERT_EQ(figures.lines.size(), 1U);
  expect_x_line(figures.lines[0].figures.readings);
}

TEST(StandardFigures, DeviationColumnsAreTakenAsTheyAre) {
  Campaign campaign = empty_campaign();
  auto points = x_line(0.5, 0.0, +1);
  for (Point& point : points) point.value -= point.at.x() - 0.1;
  add_setup(campaign, "line_X", "displacement", points).readings.column_set = 1;
  const auto figures =
      standard_figures(campaign, records_of(campaign, [](auto, auto, double reading) { return reading; }));
  ASSERT_EQ(figures.lines.size(), 1U);
  expect_x_line(figures.lines[0].figures.readings);
}

/// Two places of one axis in one setup: the passes at Y 500 and at Y 600 are two lines, separated by `line`.
TEST(StandardFigures, PassesAtDifferentPlacesAreDifferentLines) {
  Campaign campaign = empty_campaign();
  auto points = x_line(0.5, 0.0, +1);
  for (Point point : x_line(0.6, 0.0, +1)) {
    point.line += 10;
    points.push_back(point);
  }
  add_setup(campaign, "line_X", "displacement", points).options.set("direction", Vector3d(1, 0, 0));
  const auto figures =
      standard_figures(campaign, records_of(campaign, [](auto, auto, double reading) { return reading; }));
  ASSERT_EQ(figures.lines.size(), 2U);
  EXPECT_EQ(figures.lines[0].place, "Y 500, Z 400 mm");
  EXPECT_EQ(figures.lines[1].place, "Y 600, Z 400 mm");
  expect_x_line(figures.lines[0].figures.readings);
  expect_x_line(figures.lines[1].figures.readings);
}

/// Of a line along X whose passes have zeros of their own.
auto figures_with_own_zeros(const std::vector<Point>& points, Campaign& campaign) {
  volcal::Setup& setup = add_setup(campaign, "line_X", "displacement", points);
  setup.options.set("direction", Vector3d(1, 0, 0));
  setup.options.set("offset_per", std::string("line"));
  return standard_figures(campaign, records_of(campaign, [](auto, auto, double reading) { return reading; }));
}

/// Each pass shifted by its own zero: what compares passes is not defined, the rest is as before. + pass 1:
/// 0, 5, 8 less their mean 13/3; + pass 2: 2, 5, 10 less 17/3. Means: -4, 0, 4 with halves of the sums
/// (-13/3 - 11/3) / 2 = -4, (2/3 - 2/3) / 2 = 0, (11/3 + 13/3) / 2 = 4: E+ = 8.
TEST(StandardFigures, LinesWithTheirOwnZeroHaveNoReversal) {
  Campaign campaign = empty_campaign();
  auto points = x_line(0.5, 0.0, +1);
  for (Point& point : points) point.value += point.line * 1e-3;
  const auto figures = figures_with_own_zeros(points, campaign);
  ASSERT_EQ(figures.lines.size(), 1U);
  const PositioningFigures& line = figures.lines[0].figures.readings;
  EXPECT_FALSE(line.reversal || line.mean_reversal || line.systematic || line.repeatability || line.accuracy);
  EXPECT_NEAR(*line.positive.systematic, 8e-6, 1e-12);
  EXPECT_THAT(sentences(figures.lines[0].notes), ::testing::Contains(HasSubstr("own zero")));
  EXPECT_THAT(sentences(figures.lines[0].notes), ::testing::Not(::testing::Contains(HasSubstr("towards"))));
}

/// A line towards - that lacks a target compares with none of its direction; those towards + stay.
TEST(StandardFigures, LinesWithTheirOwnZeroLoseTheDirectionWhoseTargetsDiffer) {
  Campaign campaign = empty_campaign();
  auto points = x_line(0.5, 0.0, +1);
  points.pop_back();
  const auto figures = figures_with_own_zeros(points, campaign);
  ASSERT_EQ(figures.lines.size(), 1U);
  const PositioningFigures& line = figures.lines[0].figures.readings;
  EXPECT_TRUE(line.positive.systematic);
  EXPECT_FALSE(line.negative.systematic || line.mean_bidirectional);
  EXPECT_THAT(sentences(figures.lines[0].notes),
              ::testing::Contains(HasSubstr("the lines towards - do not share their targets")));
}

/// X falls by 0.6 and Y rises by 0.8 per metre: a face diagonal of 0.5 m, named by its first pass. Deviations
/// 0, 4, 10 um outward and 12, 6, 2 um back: E = 12, B = max(2, 2, 2) = 2.
TEST(StandardFigures, TwoMovingAxesAreAFaceDiagonal) {
  Campaign campaign = empty_campaign();
  const double along[] = {0.0, 0.25, 0.5, 0.5, 0.25, 0.0};
  const double deviation_um[] = {0, 4, 10, 12, 6, 2};
  std::vector<Point> points;
  points.reserve(6);
  for (int k = 0; k < 6; ++k) {
    points.push_back({Vector3d(0.8 - 0.6 * along[k], 0.1 + 0.8 * along[k], 0.2),
                      along[k] + deviation_um[k] * 1e-6, k < 3 ? 0 : 1});
  }
  add_setup(campaign, "face", "displacement", points);
  const auto figures =
      standard_figures(campaign, records_of(campaign, [](auto, auto, double reading) { return reading; }));
  ASSERT_EQ(figures.diagonals.size(), 1U);
  EXPECT_EQ(figures.diagonals[0].figures.readings.name, "-X+Y");
  EXPECT_THAT(figures.diagonals[0].axes, ElementsAre(AxisName::X, AxisName::Y));
  ASSERT_EQ(figures.diagonal_groups.size(), 1U);
  EXPECT_NEAR(*figures.diagonal_groups[0].summary.readings.systematic, 12e-6, 1e-12);
  EXPECT_NEAR(*figures.diagonal_groups[0].summary.readings.reversal, 2e-6, 1e-12);
  EXPECT_THAT(sentences(figures.diagonals[0].notes), ::testing::Contains(HasSubstr("R and A are undefined")));
}

/// One axis at a time: the corners of the staircase lie far off any line.
TEST(StandardFigures, SequentialStepsAreNoDiagonal) {
  Campaign campaign = empty_campaign();
  add_setup(campaign, "steps", "displacement",
            {{{0.0, 0.0, 0.0}}, {{0.1, 0.0, 0.0}}, {{0.1, 0.1, 0.0}}, {{0.2, 0.1, 0.0}}});
  const auto figures =
      standard_figures(campaign, records_of(campaign, [](auto, auto, double reading) { return reading; }));
  EXPECT_THAT(figures.lines, IsEmpty());
  EXPECT_THAT(figures.diagonals, IsEmpty());
  EXPECT_THAT(sentences(figures.not_recognised),
              ElementsAre("steps: the commanded points do not lie on a straight line"));
}

/// The turning point is read twice but the columns say that both came from below: 0.3 has no approach from
/// above.
TEST(StandardFigures, TargetsMetFromOneDirectionAreCounted) {
  Campaign campaign = empty_campaign();
  volcal::Setup& setup = add_setup(campaign, "line_X", "displacement", x_line(0.5, 0.0, +1));
  setup.options.set("direction", Vector3d(1, 0, 0));
  setup.readings.direction[0] = {1, 1, 1, 1, -1, -1, 1, 1, 1, 1, -1, -1};
  const auto figures =
      standard_figures(campaign, records_of(campaign, [](auto, auto, double reading) { return reading; }));
  ASSERT_EQ(figures.lines.size(), 1U);
  EXPECT_THAT(sentences(figures.lines[0].notes),
              ElementsAre("1 of 3 targets were met from one direction only"));
  EXPECT_EQ(figures.lines[0].figures.readings.targets[2].positive.count, 4);
}

/// The second reading of run 1, at 0.2 m, is left out and 1 mm off: what remains there from below is 5 um.
TEST(StandardFigures, ReadingsLeftOutDoNotCount) {
  Campaign campaign = empty_campaign();
  volcal::Setup& setup = add_setup(campaign, "line_X", "displacement", x_line(0.5, 0.0, +1));
  setup.options.set("direction", Vector3d(1, 0, 0));
  setup.readings.value[0][1] += 1e-3;
  auto records = records_of(campaign, [](auto, auto, double reading) { return reading; });
  records[1].removed = records[1].left_out = true;
  const auto figures = standard_figures(campaign, records);
  ASSERT_EQ(figures.lines.size(), 1U);
  const PositioningTarget& target = figures.lines[0].figures.readings.targets[1];
  EXPECT_EQ(target.positive.count, 1);
  EXPECT_NEAR(target.positive.mean, 5e-6, 1e-12);
}

TEST(StandardFigures, BeamAcrossTheMotionIsNoPositioningTest) {
  Campaign campaign = empty_campaign();
  add_setup(campaign, "line_X", "displacement", x_line(0.5, 0.0, +1))
      .options.set("direction", Vector3d(0, 1, 0));
  const auto figures =
      standard_figures(campaign, records_of(campaign, [](auto, auto, double reading) { return reading; }));
  EXPECT_THAT(figures.lines, IsEmpty());
  EXPECT_THAT(sentences(figures.not_recognised), ElementsAre(HasSubstr("beam")));
}

/// A circle of 150 mm in ZX: counter-clockwise (seen from +Y) from +Z to +X, 10 + 4 cos 2a um, and clockwise
/// -3 + 2 cos 2a um as in the test of the figures themselves: G = 8 and 4, G(b) = 19, D = 3.5, F = 14 and 6.
std::vector<Point> zx_circle(const Vector3d& centre, double radius) {
  std::vector<Point> points;
  for (const int sense : {+1, -1}) {
    for (int k = 0; k < 72; ++k) {
      const double angle = sense * k * 5.0 * kRadianPerDegree;
      const double deviation_um =
          sense > 0 ? 10.0 + 4.0 * std::cos(2.0 * angle) : -3.0 + 2.0 * std::cos(2.0 * angle);
      const Vector3d radial(std::sin(angle), 0.0, std::cos(angle));
      points.push_back({centre + radius * radial, radius + deviation_um * 1e-6, sense > 0 ? 0 : 1});
    }
  }
  return points;
}

TEST(StandardFigures, BallBarCircleInZX) {
  Campaign campaign = empty_campaign();
  const Vector3d centre(0.5, 0.4, 0.3);
  volcal::Setup& setup = add_setup(campaign, "bar", "ball-bar", zx_circle(centre, 0.15));
  setup.options.set("centre", Vector3d(centre + campaign.machine.tools[0].offset));
  setup.options.set("length_sigma", 0.0);
  const auto figures =
      standard_figures(campaign, records_of(campaign, [](auto, auto, double) { return 0.15; }));
  ASSERT_EQ(figures.circles.size(), 1U);
  const CircleTest& circle = figures.circles[0];
  EXPECT_EQ(circle.first, AxisName::Z);
  EXPECT_EQ(circle.second, AxisName::X);
  EXPECT_NEAR(circle.radius, 0.15, 1e-12);
  EXPECT_LT((circle.centre_w - centre - campaign.machine.tools[0].offset).norm(), 1e-12);
  EXPECT_THAT(circle.notes, IsEmpty());
  const CircularFigures& readings = circle.figures.readings;
  ASSERT_TRUE(readings.counter_clockwise && readings.clockwise);
  EXPECT_NEAR(readings.counter_clockwise->circular_deviation, 8e-6, 1e-11);
  EXPECT_NEAR(readings.clockwise->circular_deviation, 4e-6, 1e-11);
  EXPECT_NEAR(readings.counter_clockwise->radial_max, 14e-6, 1e-11);
  EXPECT_NEAR(readings.counter_clockwise->radial_min, 6e-6, 1e-11);
  EXPECT_NEAR(*readings.bidirectional, 19e-6, 1e-11);
  EXPECT_NEAR(*readings.mean_radial, 3.5e-6, 1e-11);
  EXPECT_NEAR(*circle.figures.model.bidirectional, 0.0, 1e-12);
  // What is drawn: the deviations themselves, in the order of the file; the model predicts the circle.
  EXPECT_EQ(circle.setup_index, 0U);
  ASSERT_EQ(circle.radial.readings.size(), 144U);
  EXPECT_EQ(circle.rows.at(73), 73U);
  EXPECT_NEAR(circle.radial.readings[0].deviation, 14e-6, 1e-11);
  EXPECT_NEAR(circle.radial.readings[73].deviation, (-3.0 + 2.0 * std::cos(10.0 * kRadianPerDegree)) * 1e-6,
              1e-11);
  EXPECT_NEAR(circle.radial.readings[73].angle, -5.0 * kRadianPerDegree, 1e-12);
  EXPECT_EQ(circle.radial.readings[73].sense, -1);
  EXPECT_NEAR(circle.radial.model[73].deviation, 0.0, 1e-11);
}

/// The bar's centre ball stands 80 mm below the circle: lengths sqrt(r^2 + h^2), 170 mm for 150 and 80.
TEST(StandardFigures, ConicalCircleIsBroughtToItsPlane) {
  Campaign campaign = empty_campaign();
  const Vector3d centre(0.5, 0.4, 0.3);
  auto points = zx_circle(centre, 0.15);
  for (Point& point : points) point.value = std::hypot(point.value, 0.08);
  EXPECT_NEAR(std::hypot(0.15, 0.08), 0.17, 1e-12);
  volcal::Setup& setup = add_setup(campaign, "bar", "ball-bar", points);
  setup.options.set("centre", Vector3d(centre + campaign.machine.tools[0].offset - Vector3d(0, 0.08, 0)));
  const auto figures =
      standard_figures(campaign, records_of(campaign, [](auto, auto, double reading) { return reading; }));
  ASSERT_EQ(figures.circles.size(), 1U);
  EXPECT_NEAR(*figures.circles[0].figures.readings.bidirectional, 19e-6, 1e-11);
  EXPECT_NEAR(*figures.circles[0].figures.readings.mean_radial, 3.5e-6, 1e-11);
  EXPECT_THAT(sentences(figures.circles[0].notes), ElementsAre(HasSubstr("not calibrated")));
}

TEST(StandardFigures, SphericalBallBarRunIsNoCircle) {
  Campaign campaign = empty_campaign();
  std::vector<Point> points;
  for (int k = 0; k < 20; ++k) {
    const double a = 0.3 * k, b = 0.07 * k;
    points.push_back({Vector3d(0.5 + 0.15 * std::cos(a) * std::cos(b), 0.5 + 0.15 * std::sin(a) * std::cos(b),
                               0.5 + 0.15 * std::sin(b)),
                      0.15});
  }
  add_setup(campaign, "sphere", "ball-bar", points);
  const auto figures =
      standard_figures(campaign, records_of(campaign, [](auto, auto, double reading) { return reading; }));
  EXPECT_THAT(figures.circles, IsEmpty());
  EXPECT_THAT(sentences(figures.not_recognised),
              ElementsAre("sphere: the number of axes that move is not two"));
}

/// Error vectors (1, 0, 0) um more at x = 1 than at x = 0 on a unit square; aligned rigidly: -0.5, +0.5 in x.
/// A shear-free stretch survives the alignment: range (1, 0, 0), RMS = max = 0.5 um. The model says no error;
/// the difference is not aligned: |e| 0 and 1, RMS sqrt(1/2).
TEST(StandardFigures, VolumetricPointsAreAlignedByThemselves) {
  Campaign campaign = empty_campaign();
  volcal::Setup& setup = add_setup(campaign, "points", "volumetric-points",
                                   {{{0, 0, 0}}, {{1, 0, 0}, 1e-6}, {{0, 1, 0}}, {{1, 1, 0}, 1e-6}});
  setup.readings.value.resize(3, std::vector<double>(4, 0.0));
  const auto figures =
      standard_figures(campaign, records_of(campaign, [](auto, auto, double) { return 0.0; }));
  ASSERT_EQ(figures.points.size(), 1U);
  EXPECT_NEAR(figures.points[0].figures.readings.range.x(), 1e-6, 1e-15);
  EXPECT_NEAR(figures.points[0].figures.readings.range.y(), 0.0, 1e-15);
  EXPECT_NEAR(figures.points[0].figures.readings.rms, 0.5e-6, 1e-15);
  EXPECT_NEAR(figures.points[0].figures.readings.max, 0.5e-6, 1e-15);
  EXPECT_NEAR(figures.points[0].difference.rms, std::sqrt(0.5) * 1e-6, 1e-15);
}

/// Directions of a diagonal: columns that agree with the motion along it count; (+1, +1) on a diagonal -X+Y
/// contradicts itself and the order decides.
TEST(TestPaths, ColumnsThatDisagreeOnADiagonalGiveWayToTheOrder) {
  Campaign campaign = empty_campaign();
  volcal::Setup& setup =
      add_setup(campaign, "face", "displacement", {{{0.5, 0.0, 0.0}}, {{0.4, 0.1, 0.0}}, {{0.3, 0.2, 0.0}}});
  setup.readings.direction[0] = {+1, -1, +1};
  setup.readings.direction[1] = {+1, +1, -1};
  const auto found = straight_paths(campaign, setup);
  ASSERT_EQ(found.paths.size(), 1U);
  EXPECT_THAT(found.paths[0].approach, ElementsAre(+1, +1, -1));
  EXPECT_EQ(found.paths[0].name, "-X+Y");
}

}  // namespace
}  // namespace volcal
