// Machines of two linear axes: what is measured on them, and what is refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "volcal/model/description/errors.h"
#include "volcal/sim/machine/datum.h"
#include "volcal/sim/machine/random_truth.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/measurement/measurements.h"

namespace volcal::sim {
namespace {

using ::testing::HasSubstr;

Machine plane_machine(const std::string& code) {
  Machine machine = machine_from_code(code, {{{-0.3, 0.3}, {-0.3, 0.3}, {-0.5, 0.0}}});
  machine.datum = {AxisName::X, AxisName::Z};
  for (Axis& axis : machine.axes) {
    if (is_rotary(axis.name)) axis.centre = {0.0, 0.0, -0.4};
  }
  machine.tools = {{"short", {0.0, 0.0, -0.15}, 0.0}, {"side", {0.08, 0.0, -0.2}, 0.0}};
  return machine;
}

std::set<std::string> names_of(const MeasurementSettings& settings, const Machine& machine) {
  std::set<std::string> names;
  for (const SetupPlan& plan : plan_setups({"", settings, {}}, machine, 1)) names.insert(plan.name);
  return names;
}

std::string answer(const MeasurementSettings& settings, const Machine& machine) {
  try {
    plan_setups({"", settings, {}}, machine, 1);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// One position along the axis that is not there: 9 x 6 there and back.
TEST(TwoLinearAxes, AGridLiesInTheirPlane) {
  const auto plans = plan_setups({"", Tracking{}, {}}, plane_machine("w X' b Z t"), 1);
  ASSERT_FALSE(plans.empty());
  EXPECT_EQ(plans[0].points.size(), 2U * 9U * 6U);
  const auto points = plan_setups({"", PointGrid{}, {}}, plane_machine("w X' b Z t"), 1);
  EXPECT_EQ(points.at(0).points.size(), 5U * 3U);
}

TEST(TwoLinearAxes, MeasurementsAreThoseOfTheirPlane) {
  const Machine machine = plane_machine("w X' b Z t");
  EXPECT_EQ(names_of(AxisLines{}, machine), (std::set<std::string>{"line_X", "line_Z"}));
  EXPECT_EQ(names_of(BallBarCircles{}, machine), std::set<std::string>{"ballbar_ZX"});
  EXPECT_EQ(names_of(Squares{}, machine), (std::set<std::string>{"square_ZX_along_X", "square_ZX_along_Z"}));
  EXPECT_EQ(names_of(AngleLines{}, machine).size(), 6U) << "of X and Z, about x, y and z";
  Diagonals diagonals;
  EXPECT_THAT(answer(diagonals, machine), HasSubstr("diagonals = \"face\""));
  diagonals.kind = Diagonals::Kind::Face;
  EXPECT_EQ(names_of(diagonals, machine), (std::set<std::string>{"face_XZ_pp", "face_XZ_np"}));
  AxisLines of_missing;
  of_missing.axes = {AxisName::Y};
  EXPECT_THAT(answer(of_missing, machine), HasSubstr("the machine has no axis Y"));
  BallBarCircles across;
  across.planes = {"XY"};
  EXPECT_THAT(answer(across, machine), HasSubstr("the machine has no axis Y"));
  EXPECT_THAT(answer(AxisLines{}, plane_machine("w C' b X t")), HasSubstr("fewer than two of the axes"));
}

/// B turns about the normal of the plane: X and Z follow. By hand: the place (100, 0, -400) mm lies 100 mm
/// from the line of B; at B = 90 deg it has gone below or above the line, and the tool of 150 mm follows.
TEST(TwoLinearAxes, FollowWhatTurnsAboutTheirNormal) {
  RTest settings;
  settings.poses.spheres = {{"S", {0.1, 0.0, -0.4}}};
  settings.poses.tools = {"short"};
  settings.poses.grid.points = {{AxisName::B, 3}};
  settings.poses.grid.range = {{AxisName::B, {-0.5 * std::numbers::pi, 0.5 * std::numbers::pi}}};
  const auto plans = plan_setups({"", settings, {}}, plane_machine("w B' X' b Z t"), 1);
  ASSERT_EQ(plans.at(0).points.size(), 3U);
  const auto& up = plans[0].points[0].position;
  // p_w = c + Ry(B) (p - c): at B = -90 deg p - c = Ry(90) (100, 0, 0) = (0, 0, -100).
  EXPECT_NEAR(up[index_of(AxisName::X)], 0.0, 1e-12);
  EXPECT_NEAR(up[index_of(AxisName::Z)], -0.5 + 0.15, 1e-12);
  settings.poses.spheres[0].position_w.y() = 0.01;
  EXPECT_THAT(answer(settings, plane_machine("w B' X' b Z t")),
              HasSubstr("does not stay on its sphere by X and Z alone"));
  settings.poses.grid = {};
  settings.poses.spheres[0].position_w = {0.1, 0.0, -0.4};
  EXPECT_THAT(answer(settings, plane_machine("w C' b Z X t")), HasSubstr("kind = \"angle-lines\""));
  ProbedSphere contacts;
  contacts.poses = settings.poses;
  contacts.contacts = true;
  EXPECT_THAT(answer(contacts, plane_machine("w B' X' b Z t")), HasSubstr("record centres"));
}

/// Squareness is one, of Z to X, and the error in the plane is what was asked for.
TEST(TwoLinearAxes, ARandomTruthHasOneSquareness) {
  const Machine machine = plane_machine("w X' b Z t");
  RandomTruthOptions options;
  options.volumetric_rms_min = options.volumetric_rms_max = 5e-6;
  const TruthMachine truth = random_truth(machine, 3, options);
  EXPECT_NEAR(volumetric_rms(truth, machine.tools[0].offset), 5e-6, 1e-10);
  EXPECT_NE(truth.location({Component::B, AxisName::Z}), 0.0);
  const TruthInDatum datum(truth);
  EXPECT_EQ(datum.datum().squareness()[0].name(), "EB0Z");
  // By hand: EB0Z of the datum is that of the truth and the slopes of EXZ and EZX that the datum takes out.
  const double slope_x = least_squares_slope(
      [&](double q) {
        return truth.function_value({Component::Z, AxisName::X}, q);
      },
      -0.3, 0.3);
  const double slope_z = least_squares_slope(
      [&](double q) {
        return truth.function_value({Component::X, AxisName::Z}, q);
      },
      -0.5, 0.0);
  EXPECT_NEAR(datum.squareness()[0], truth.location({Component::B, AxisName::Z}) + slope_z + slope_x, 1e-12);
}

}  // namespace
}  // namespace volcal::sim
