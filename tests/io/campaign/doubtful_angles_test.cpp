// Positions of rotary axes in radians or with the wrong sign: what the readings of a sphere, a bar and a
// tracer say of them.

#include "volcal/identify/io/campaign/doubtful_angles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/machines.h"
#include "volcal/identify/words/sentences.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

constexpr double kPlaceX = 0.1;  // m, of the sphere, workpiece coordinates
constexpr double kPlaceY = 0.05;

Machine table_and_head() {
  Machine machine = testing_support::machine_of("w C' X' b Y Z B t");
  for (Axis& axis : machine.axes) {
    axis.centre = Eigen::Vector3d::Zero();
    axis.travel_min = is_rotary(axis.name) ? -400.0 * kRadianPerDegree : -2.0;
    axis.travel_max = -axis.travel_min;
  }
  machine.tools = {{"probe", Eigen::Vector3d(0.0, 0.0, -0.2), 0.0}};
  return machine;
}

/// The tool point stays at (100, 50, 0) mm of the workpiece: by hand, C turns that place by -C in the bed
/// (the tool's position relative to the workpiece grows with +C), and B turns the tool's 200 mm.
void follow(double b, double c, Setup& setup) {
  const double x = std::cos(c) * kPlaceX + std::sin(c) * kPlaceY;
  const double y = -std::sin(c) * kPlaceX + std::cos(c) * kPlaceY;
  auto& position = setup.readings.position;
  position[index_of(AxisName::X)].push_back(x + 0.2 * std::sin(b));
  position[index_of(AxisName::Y)].push_back(y);
  position[index_of(AxisName::Z)].push_back(0.2 * std::cos(b));
  position[index_of(AxisName::B)].push_back(b);
  position[index_of(AxisName::C)].push_back(c);
  setup.readings.source_line.push_back(static_cast<std::int64_t>(setup.readings.source_line.size()) + 2);
}

/// Angles of no round numbers.
Setup poses(const std::string& instrument) {
  volcal::Setup setup;
  setup.name = "S1";
  setup.instrument = instrument;
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j < 5; ++j) follow(0.37 * (j - 2) + 0.013 * i, 0.61 * (i - 3) + 0.017 * j, setup);
  }
  const std::size_t rows = setup.readings.source_line.size();
  setup.readings.value.assign(instrument == "ball-bar" || instrument == "laser-tracer" ? 1 : 3,
                              std::vector<double>(rows, 0.0));
  return setup;
}

/// As if the file gave `factor` times the degrees.
Setup misread(Setup setup, AxisName axis, double factor) {
  for (double& q : setup.readings.position[index_of(axis)]) q *= factor;
  return setup;
}

std::string doubt_about(const Setup& setup) {
  auto finding = doubtful_angles(setup, table_and_head());
  if (!finding) return "";
  finding->data["setup"] = setup.name;
  finding->data["file"] = std::string("s1.csv");
  return sentence(*finding);
}

TEST(DoubtfulAngles, RightPositionsRaiseNone) {
  EXPECT_EQ(doubt_about(poses("r-test")), "");
  EXPECT_EQ(doubt_about(poses("probed-sphere")), "");
}

TEST(DoubtfulAngles, ASphereTellsAWrongSign) {
  EXPECT_THAT(doubt_about(misread(poses("r-test"), AxisName::C, -1.0)),
              HasSubstr("with c_deg reversed by 0.0 mm: if so add scale = { c_deg = -1 }"));
  EXPECT_THAT(doubt_about(misread(poses("probed-sphere"), AxisName::B, -1.0)),
              HasSubstr("scale = { b_deg = -1 }"));
  EXPECT_THAT(doubt_about(misread(misread(poses("r-test"), AxisName::B, -1.0), AxisName::C, -1.0)),
              HasSubstr("scale = { b_deg = -1, c_deg = -1 }"));
}

TEST(DoubtfulAngles, ASphereTellsRadians) {
  EXPECT_THAT(doubt_about(misread(poses("r-test"), AxisName::C, kRadianPerDegree)),
              HasSubstr("with c_deg in radians by 0.0 mm: if so add scale = { c_deg = 57.2957795131 }"));
  EXPECT_THAT(
      doubt_about(misread(poses("r-test"), AxisName::B, -kRadianPerDegree)),
      HasSubstr("with b_deg in radians and reversed by 0.0 mm: if so add scale = { b_deg = -57.29577951"));
}

/// Workpiece coordinates of a control with tool centre point motion stand still: 112 mm from the axis of C,
/// 200 mm from that of B. Of contacts and diameters the tool point is not at one place.
TEST(DoubtfulAngles, PositionsThatMissTheSphereWhateverTheAnglesAreTold) {
  auto setup = poses("r-test");
  for (const AxisName axis : {AxisName::X, AxisName::Y, AxisName::Z}) {
    auto& column = setup.readings.position[index_of(axis)];
    column.assign(column.size(), 0.1);
  }
  EXPECT_THAT(doubt_about(setup), HasSubstr("the nominal tool point scatters by 1"));
  EXPECT_THAT(doubt_about(setup), HasSubstr("are its positions those of the machine's axes"));
  auto diameters = setup;
  diameters.instrument = "probed-sphere";
  EXPECT_THAT(doubt_about(diameters), HasSubstr("the nominal tool point scatters"));
  diameters.readings.value.resize(1);
  EXPECT_EQ(doubt_about(diameters), "");
}

/// A bar of 150 mm along z above the place keeps its length: the same joints, 150 mm higher.
TEST(DoubtfulAngles, ABarTellsItByItsLength) {
  auto setup = poses("ball-bar");
  for (double& z : setup.readings.position[index_of(AxisName::Z)]) z += 0.15;
  setup.options.set("centre", Eigen::Vector3d(kPlaceX, kPlaceY, 0.0));
  EXPECT_EQ(doubt_about(setup), "");
  EXPECT_THAT(doubt_about(misread(setup, AxisName::C, -1.0)), HasSubstr("scale = { c_deg = -1 }"));
}

/// A tracer at the workpiece reads the distance of the place, 0.5 m less its dead path, at every pose.
TEST(DoubtfulAngles, ATracerTellsItByItsStation) {
  auto setup = poses("laser-tracer");
  setup.options.set("station", Eigen::Vector3d(kPlaceX + 0.3, kPlaceY, 0.4));
  setup.readings.value[0].assign(setup.readings.size(), 0.5 - 0.1);
  EXPECT_EQ(doubt_about(setup), "");
  EXPECT_THAT(doubt_about(misread(setup, AxisName::C, kRadianPerDegree)),
              HasSubstr("scale = { c_deg = 57.2957795131 }"));
  setup.options = {};
  EXPECT_EQ(doubt_about(misread(setup, AxisName::C, -1.0)), "") << "nothing is known of the station";
}

/// One axis that turns alone: nothing but its numbers tells. 0, 30 ... 330 deg with four decimals of a
/// radian.
TEST(DoubtfulAngles, WholeDegreesAsRadiansAreNamed) {
  volcal::Setup setup;
  setup.name = "C";
  setup.instrument = "angle";
  for (int i = 0; i < 12; ++i) {
    const double written = std::round(i * std::acos(-1.0) / 6.0 * 1e4) / 1e4;  // 0.5236 for 30 deg
    for (const AxisName axis : {AxisName::X, AxisName::Y, AxisName::Z, AxisName::B})
      setup.readings.position[index_of(axis)].push_back(0.0);
    setup.readings.position[index_of(AxisName::C)].push_back(written * kRadianPerDegree);
    setup.readings.source_line.push_back(i + 2);
  }
  setup.readings.value.assign(1, std::vector<double>(12, 0.0));
  EXPECT_THAT(doubt_about(setup), HasSubstr("are whole degrees if it is in radians"));
  auto& degrees = setup.readings.position[index_of(AxisName::C)];
  for (int i = 0; i < 12; ++i) degrees[static_cast<std::size_t>(i)] = 0.5 * i * kRadianPerDegree;
  EXPECT_EQ(doubt_about(setup), "") << "a small arc in half degrees";
}

}  // namespace
}  // namespace volcal
