// Direct tests of rotary axes and drift at rest: where the machine stands, and readings by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "volcal/model/description/errors.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/measurement/instruments.h"
#include "volcal/sim/measurement/measurements.h"
#include "volcal/sim/study.h"

namespace volcal::sim {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kDegree = std::numbers::pi / 180.0;

/// Rotary centres at (20, 30, -400) mm, tools of 150 and 250 mm along the spindle.
Machine direct_test_machine(const std::string& code) {
  Machine machine = machine_from_code(code, {{{-0.5, 0.5}, {-0.5, 0.5}, {-0.5, 0.5}}});
  for (Axis& axis : machine.axes) {
    if (is_rotary(axis.name)) axis.centre = {0.02, 0.03, -0.4};
  }
  machine.tools = {{"short", {0.0, 0.0, -0.15}, 0.0}, {"long", {0.0, 0.0, -0.25}, 0.0}};
  return machine;
}

std::string refused(const MeasurementSettings& settings, const Machine& machine) {
  try {
    plan_setups({"", settings, {}}, machine, 1);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

NoiseLevel no_noise() { return {}; }

/// On the line of C at heights 0 and 100 mm: X = 20, Y = 30 and, the tool 150 mm below the spindle, Z = -400
/// + 150 and 100 more. A turn of 36 positions ends a step before its start.
TEST(AxisOfRotationPlan, TheToolStandsOnTheLine) {
  AxisOfRotation settings;
  settings.heights = {0.0, 0.1};
  settings.runs = 1;
  const auto plans = plan_setups({"", settings, {}}, direct_test_machine("w C' b X Y Z t"), 1);
  ASSERT_EQ(plans.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_EQ(plans[i].points.size(), 36U);
    for (std::size_t k = 0; k < 36; ++k) {
      const auto& position = plans[i].points[k].position;
      EXPECT_NEAR(position[index_of(AxisName::X)], 0.02, 1e-12);
      EXPECT_NEAR(position[index_of(AxisName::Y)], 0.03, 1e-12);
      EXPECT_NEAR(position[index_of(AxisName::Z)], i == 0 ? -0.25 : -0.15, 1e-12);
      EXPECT_NEAR(position[index_of(AxisName::C)], (-180.0 + 10.0 * static_cast<double>(k)) * kDegree, 1e-12);
    }
  }
}

/// Of a lathe X and Z alone bring the tool there: the line lies in their plane.
TEST(AxisOfRotationPlan, TwoLinearAxesReachALineInTheirPlane) {
  Machine lathe = direct_test_machine("w C' b Z X t");
  EXPECT_THAT(refused(AxisOfRotation{}, lathe),
              AllOf(HasSubstr("tool short does not come onto the line of C: it stays 30 mm away"),
                    HasSubstr("name a tool that stands on the line")));
  for (Axis& axis : lathe.axes) axis.centre.y() = 0.0;
  const auto plans = plan_setups({"", AxisOfRotation{}, {}}, lathe, 1);
  ASSERT_EQ(plans.size(), 1U);
  EXPECT_NEAR(plans[0].points[0].position[index_of(AxisName::X)], 0.02, 1e-12);
  EXPECT_NEAR(plans[0].points[0].position[index_of(AxisName::Z)], -0.25, 1e-12);
}

/// A head turns the tool about itself: it stands on the line wherever X, Y, Z are, and its length says where.
TEST(AxisOfRotationPlan, AHeadTurnsTheToolAboutItself) {
  Machine head = direct_test_machine("w X' b Y Z C t");
  for (Axis& axis : head.axes) axis.centre = {0.0, 0.0, 0.1};
  AxisOfRotation settings;
  settings.tools = {"short", "long"};
  EXPECT_EQ(plan_setups({"", settings, {}}, head, 1).size(), 2U);
  settings.heights = {0.0};
  EXPECT_THAT(refused(settings, head), HasSubstr("leave out heights_mm"));
  Machine tilting = direct_test_machine("w X' b Y Z B t");
  EXPECT_THAT(refused(AxisOfRotation{}, tilting), HasSubstr("does not come onto the line of B"));
  EXPECT_THAT(refused(AxisOfRotation{}, direct_test_machine("w X' b Y Z t")), HasSubstr("no rotary axis"));
}

/// EXC = 3 um cos 2C and EZC = 5 um of a table, read in the axes of the bed: the displacement of the tool
/// against the table is that of the error motion, whatever the table's angle.
TEST(AxisOfRotationReadings, AreTheErrorMotions) {
  const Machine machine = direct_test_machine("w C' b X Y Z t");
  TruthMachine truth(machine);
  truth.set_error({Component::X, AxisName::C}, [](double q) { return 3e-6 * std::cos(2.0 * q); });
  truth.set_error({Component::Z, AxisName::C}, [](double) { return 5e-6; });
  AxisOfRotation settings;
  settings.frame = "machine";
  settings.offset_spread = 0.0;
  settings.noise = no_noise();
  const auto plans = plan_setups({"", settings, {}}, machine, 1);
  const Environment environment;
  const auto setup =
      measure(plans.at(0), {truth, environment, {machine.tools[0].offset}, 1, false, true}, 0.0);
  ASSERT_EQ(setup.readings.size(), 72U);
  for (std::size_t row = 0; row < 72; ++row) {
    const double q = setup.readings.position[index_of(AxisName::C)][row];
    EXPECT_NEAR(setup.readings.value[0][row], 3e-6 * std::cos(2.0 * q), 1e-12);
    EXPECT_NEAR(setup.readings.value[1][row], 0.0, 1e-12);
    EXPECT_NEAR(setup.readings.value[2][row], 5e-6, 1e-12);
  }
}

/// ECC = 40 urad sin C with a reversal of 20 urad: the angle about +z, 10 urad more on the way up, 10 less on
/// the way down; the same of A, whose axis lies along +y of the workpiece with the table C at 90 deg.
TEST(RotaryAngleLines, ReadTheAngleAboutTheAxis) {
  for (const AxisName axis : {AxisName::C, AxisName::A}) {
    Machine machine = direct_test_machine("w C' A' b X Y Z t");
    for (Axis& each : machine.axes) {
      if (each.name == AxisName::C) each.home = 90.0 * kDegree;
    }
    const ErrorSymbol own{axis == AxisName::C ? Component::C : Component::A, axis};
    TruthMachine truth(machine);
    truth.set_error(own, [](double q) { return 40e-6 * std::sin(q); });
    truth.set_reversal(own, 20e-6);
    AngleLines settings;
    settings.axes = {axis};
    settings.points = 13;
    settings.offset_spread = 0.0;
    const auto plans = plan_setups({"", settings, {}}, machine, 1);
    ASSERT_EQ(plans.size(), 1U);
    // By hand: at C = 90 deg the tool has turned by 90 deg in the workpiece, and the bed's x is its +y.
    const Eigen::Vector3d about = axis == AxisName::C ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
    EXPECT_LT((*plans[0].options.vector("axis") - about).norm(), 1e-12);
    const Environment environment;
    const auto setup =
        measure(plans[0], {truth, environment, {machine.tools[0].offset}, 1, false, true}, 0.0);
    ASSERT_EQ(setup.readings.size(), 26U);
    for (std::size_t row = 0; row < 26; ++row) {
      const double q = setup.readings.position[index_of(axis)][row];
      const double side = row < 13 ? 1.0 : -1.0;
      EXPECT_NEAR(setup.readings.value[0][row], 40e-6 * std::sin(q) + side * 10e-6, 1e-9) << row;
    }
  }
  AngleLines level;
  level.axes = {AxisName::C};
  level.body = "table";
  EXPECT_THAT(refused(level, direct_test_machine("w C' b X Y Z t")), HasSubstr("leave body out"));
}

/// A spindle that grows by 2 um/K along -Z and tilts by 3 urad/K about Y while the channel rises by 1 K/h: in
/// two hours the short tool's point goes 4 um along Z, the long one's, 100 mm lower, 0.6 um more along -X.
TEST(DriftAtRestReadings, FollowTheTemperature) {
  Study study;
  study.machine = direct_test_machine("w X' b Y Z t");
  study.truth.perfect = true;
  study.environment.channels.resize(1);
  study.environment.channels[0].name = "spindle";
  study.environment.channels[0].start = 20.0;
  study.environment.channels[0].drift = 1.0 / 3600.0;
  DriftAtRest settings;
  settings.tools = {"short", "long"};
  settings.duration = 7200.0;
  settings.seconds_per_reading = 600.0;
  settings.noise = no_noise();
  study.measurements.push_back({"", settings, {}});
  HiddenEffect growth{"tool-growth-channel", {}, 2e-6};
  growth.options.set("channel", std::string("spindle"));
  HiddenEffect tilt{"thermal-tilt", {}, 3e-6};
  tilt.options.set("symbol", std::string("EBZ"));
  tilt.options.set("channel", std::string("spindle"));
  study.hidden = {growth, tilt};
  const SimulatedCampaign simulated = simulate(study);
  ASSERT_EQ(simulated.campaign.setups.size(), 2U);
  const Readings& low = simulated.campaign.setups[1].readings;
  const Readings& high = simulated.campaign.setups[0].readings;
  ASSERT_EQ(high.size(), 13U);
  EXPECT_EQ(high.time, low.time) << "read at the same times";
  EXPECT_DOUBLE_EQ(high.time.back() - high.time.front(), 7200.0);
  const auto change = [](const Readings& readings, std::size_t channel) {
    return readings.value[channel].back() - readings.value[channel].front();
  };
  EXPECT_NEAR(change(high, 2), -4e-6, 1e-10);
  EXPECT_NEAR(change(low, 2), -4e-6, 1e-10);
  EXPECT_NEAR(change(low, 0) - change(high, 0), -0.6e-6, 1e-10);
  EXPECT_NEAR(high.temperature.at("spindle").back() - high.temperature.at("spindle").front(), 2.0, 1e-9);
}

TEST(DriftAtRestReadings, NoTimeIsRefused) {
  DriftAtRest settings;
  settings.seconds_per_reading = 2.0 * settings.duration;
  EXPECT_THAT(refused(settings, direct_test_machine("w X' b Y Z t")), HasSubstr("give duration_s"));
}

}  // namespace
}  // namespace volcal::sim
