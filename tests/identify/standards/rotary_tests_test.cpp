// Direct tests of rotary axes and drift at rest, found among the setups of a campaign; figures by hand.

#include "volcal/identify/standards/rotary_tests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/support/machines.h"
#include "tests/support/residual_records.h"
#include "volcal/identify/words/sentences.h"

namespace volcal {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kThirty = std::numbers::pi / 6.0;

Campaign table_campaign(const std::string& structure = "w C' b X Y Z t") {
  Campaign campaign;
  campaign.machine = testing_support::machine_of(structure);
  for (Axis& axis : campaign.machine.axes) axis.centre = Vector3d::Zero();
  campaign.machine.tools = {{"probe", Vector3d::Zero(), 0.0}};
  return campaign;
}

/// A setup with the machine's axes at 0; rows are added by `read`.
Setup one_setup(const std::string& name, const std::string& instrument, std::size_t channels) {
  Setup setup;
  setup.name = name;
  setup.instrument = instrument;
  setup.readings.value.resize(channels);
  return setup;
}

void read(Setup& setup, const AxisPosition& position, const std::vector<double>& micro) {
  for (const AxisName axis : kAllAxes)
    setup.readings.position[index_of(axis)].push_back(position[index_of(axis)]);
  for (std::size_t k = 0; k < micro.size(); ++k) setup.readings.value[k].push_back(micro[k] * 1e-6);
  setup.readings.source_line.push_back(static_cast<std::int64_t>(setup.readings.size()) + 2);
}

/// Predictions are half the readings.
StandardFigures figures_of(const Campaign& campaign) {
  return standard_figures(campaign, testing::records_times(campaign, 0.5));
}

double micro(const std::optional<double>& value) { return value.value_or(NAN) * 1e6; }

/// A sphere on the axis of a table that turns by -q, read along X, Y, Z of the machine at Z = `height`.
Setup sphere_on_the_axis(const std::string& name, double height,
                         const std::function<Vector3d(double)>& micrometres) {
  Setup setup = one_setup(name, "r-test", 3);
  setup.options.set("frame", std::string("machine"));
  for (int k = 0; k < 12; ++k) {
    const double q = k * kThirty;
    AxisPosition position{};
    position[index_of(AxisName::Z)] = height;
    position[index_of(AxisName::C)] = q;
    const Vector3d value = micrometres(q);
    read(setup, position, {value.x(), value.y(), value.z()});
  }
  return setup;
}

/// Eccentric by 20 um: (20 cos q, -20 sin q) in the machine. X moves by 2 cos 2q, Z by 3 sin q. Fixed X: 4;
/// fixed Y: 0; rotating, x cos q - y sin q = 20 + 2 cos 2q cos q = 20 + cos q + cos 3q: 2; axial 6.
TEST(AxisOfRotation, OfATableByHand) {
  Campaign campaign = table_campaign();
  campaign.setups = {sphere_on_the_axis("S", 0.0, [](double q) {
    return Vector3d(20.0 * std::cos(q) + 2.0 * std::cos(2.0 * q), -20.0 * std::sin(q), 3.0 * std::sin(q));
  })};
  const auto tests = figures_of(campaign).error_motions;
  ASSERT_EQ(tests.size(), 4u);
  EXPECT_EQ(tests[0].motion, ErrorMotion::RadialFixed);
  EXPECT_EQ(tests[0].direction, 0);
  EXPECT_NEAR(micro(tests[0].figures.readings.total), 4.0, 1e-9);
  EXPECT_NEAR(micro(tests[0].figures.model.total), 2.0, 1e-9);
  EXPECT_EQ(tests[1].direction, 1);
  EXPECT_NEAR(micro(tests[1].figures.readings.total), 0.0, 1e-9);
  EXPECT_EQ(tests[2].motion, ErrorMotion::RadialRotating);
  EXPECT_NEAR(micro(tests[2].figures.readings.total), 2.0, 1e-9);
  EXPECT_EQ(tests[3].motion, ErrorMotion::Axial);
  EXPECT_EQ(tests[3].direction, 2);
  EXPECT_NEAR(micro(tests[3].figures.readings.total), 6.0, 1e-9);
  EXPECT_NEAR(micro(tests[3].figures.readings.fundamental), 6.0, 1e-9);
}

/// The same readings in the axes of the workpiece, which turns with the table, give the same figures.
TEST(AxisOfRotation, DoesNotDependOnTheFrameOfTheReadings) {
  Campaign campaign = table_campaign();
  const auto in_machine = [](double q) {
    return Vector3d(20.0 * std::cos(q) + 2.0 * std::cos(2.0 * q), -20.0 * std::sin(q) + std::sin(3.0 * q),
                    0.0);
  };
  campaign.setups = {sphere_on_the_axis("machine", 0.0, in_machine),
                     sphere_on_the_axis("workpiece", 0.0, [&](double q) {
                       return Vector3d(Eigen::AngleAxisd(q, Vector3d::UnitZ()) * in_machine(q));
                     })};
  campaign.setups[1].options.set("frame", std::string("workpiece"));
  const auto tests = figures_of(campaign).error_motions;
  ASSERT_EQ(tests.size(), 8u) << "spheres at one height give no tilt";
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_NEAR(micro(tests[k].figures.readings.total), micro(tests[4 + k].figures.readings.total), 1e-9);
}

/// 100 mm higher X moves by cos 2q um more: a tilt about Y of 10 cos 2q urad, 20 urad in all, none about X.
TEST(AxisOfRotation, TiltByTwoSpheres) {
  Campaign campaign = table_campaign();
  campaign.setups = {
      sphere_on_the_axis("low", 0.05, [](double q) { return Vector3d(std::cos(3.0 * q), 0, 0); }),
      sphere_on_the_axis("high", 0.15,
                         [](double q) { return Vector3d(std::cos(3.0 * q) + std::cos(2.0 * q), 0, 0); })};
  const auto tests = figures_of(campaign).error_motions;
  ASSERT_EQ(tests.size(), 10u);
  EXPECT_EQ(tests[8].motion, ErrorMotion::Tilt);
  EXPECT_EQ(tests[8].setup, "low, high");
  EXPECT_EQ(tests[8].direction, 0);
  EXPECT_NEAR(micro(tests[8].figures.readings.total), 0.0, 1e-9);
  EXPECT_EQ(tests[9].direction, 1);
  EXPECT_NEAR(micro(tests[9].figures.readings.total), 20.0, 1e-6);
  EXPECT_NEAR(tests[9].plots.readings.front().value * 1e6, 10.0, 1e-6) << "positive about +Y";
  EXPECT_TRUE(tests[9].is_angle());
}

/// Three turns recorded within one: at the upper sphere, 100 mm higher, they differ by -0.5, 0, 0.5 um in X,
/// at the lower one by 0.2, 0, -0.2: tilts about Y differ by 10 (1.0 + 0.4) = 14 urad between the turns,
/// which adds to 20 urad of the mean. A reading that is missing makes no other pairs.
TEST(AxisOfRotation, TurnsOfTwoSpheresArePaired) {
  for (const bool missing : {false, true}) {
    Campaign campaign = table_campaign();
    const auto turns = [](const std::string& name, double height, double apart, double wave) {
      volcal::Setup setup = sphere_on_the_axis(name, height, [&](double q) {
        return Vector3d(std::cos(3.0 * q) + wave * std::cos(2.0 * q) - apart, 0, 0);
      });
      for (const double shift : {0.0, apart}) {
        const volcal::Setup turn = sphere_on_the_axis(name, height, [&](double q) {
          return Vector3d(std::cos(3.0 * q) + wave * std::cos(2.0 * q) + shift, 0, 0);
        });
        for (std::size_t row = 0; row < turn.readings.size(); ++row)
          read(setup, turn.readings.commanded_position(row), {turn.readings.value[0][row] * 1e6, 0.0, 0.0});
      }
      return setup;
    };
    campaign.setups = {turns("low", 0.05, -0.2, 0.0), turns("high", 0.15, 0.5, 1.0)};
    std::vector<ResidualRecord> records = testing::records_times(campaign, 0.5);
    if (missing) records.erase(records.begin(), records.begin() + 3);
    const auto tests = standard_figures(campaign, records).error_motions;
    ASSERT_EQ(tests.size(), 10u);
    const ErrorMotionFigures& tilt = tests[9].figures.readings;
    EXPECT_EQ(tilt.angles, 12);
    EXPECT_NEAR(micro(tilt.asynchronous), 14.0, 1e-6);
    if (!missing) {
      EXPECT_NEAR(micro(tilt.synchronous), 20.0, 1e-6);
      EXPECT_NEAR(micro(tilt.total), 34.0, 1e-6);
    }
  }
}

TEST(AxisOfRotation, IsNoTestWhereLinearAxesFollow) {
  Campaign campaign = table_campaign();
  volcal::Setup setup = sphere_on_the_axis("R", 0.0, [](double) { return Vector3d::Zero().eval(); });
  setup.readings.position[0][3] = 0.1;
  campaign.setups = {setup};
  EXPECT_THAT(figures_of(campaign).error_motions, IsEmpty());
}

/// Targets 0.1, 0.2, 0.3 rad, deviations in urad from below and from above, twice: 0, 2 | 3, 5; 5, 5 | 4, 6;
/// 8, 10 | 7, 7. Means 1, 5, 9 and 4, 5, 7: E = 8, B = 3, M = 8 - 2.5, R = 4 sqrt 2 + 3.
Setup angles(const Vector3d& axis, double sign) {
  Setup setup = one_setup("angles", "angle", 1);
  setup.options.set("axis", axis);
  const double up[2][3] = {{0, 5, 8}, {2, 5, 10}}, down[2][3] = {{3, 4, 7}, {5, 6, 7}};
  const auto at = [&](int k, double value, int run) {
    AxisPosition position{};
    position[index_of(AxisName::C)] = 0.1 * (k + 1);
    read(setup, position, {sign * value});
    setup.readings.line.push_back(run);
  };
  for (int run = 0; run < 2; ++run) {
    for (int k = 0; k < 3; ++k) at(k, up[run][k], 2 * run);
    for (int k = 2; k >= 0; --k) at(k, down[run][k], 2 * run + 1);
  }
  return setup;
}

void expect_hand_figures(const Campaign& campaign) {
  const auto tests = figures_of(campaign).rotary_lines;
  ASSERT_EQ(tests.size(), 1u);
  EXPECT_EQ(tests[0].axis, AxisName::C);
  const PositioningFigures& figures = tests[0].figures.readings;
  EXPECT_EQ(figures.targets.size(), 3u);
  EXPECT_NEAR(micro(figures.systematic), 8.0, 1e-9);
  EXPECT_NEAR(micro(figures.reversal), 3.0, 1e-9);
  EXPECT_NEAR(micro(figures.mean_reversal), -1.0 / 3.0, 1e-9);
  EXPECT_NEAR(micro(figures.mean_bidirectional), 5.5, 1e-9);
  EXPECT_NEAR(micro(figures.repeatability), 4.0 * std::sqrt(2.0) + 3.0, 1e-9);
  EXPECT_NEAR(micro(figures.accuracy), 8.0 + 4.0 * std::sqrt(2.0), 1e-9);
  EXPECT_NEAR(micro(tests[0].figures.model.systematic), 4.0, 1e-9);
}

/// A reading about +Z counts with the command of C', about -Z against it; a level on the table turns against
/// the command, since +C turns the table by -C.
TEST(RotaryPositioning, CountsInTheSenseOfTheCommand) {
  Campaign campaign = table_campaign();
  campaign.setups = {angles(Vector3d::UnitZ(), 1.0)};
  expect_hand_figures(campaign);
  campaign.setups = {angles(-Vector3d::UnitZ(), -1.0)};
  expect_hand_figures(campaign);
  campaign.setups = {angles(Vector3d::UnitZ(), -1.0)};
  campaign.setups[0].options.set("body", std::string("table"));
  expect_hand_figures(campaign);
  Campaign head = table_campaign("w b X Y Z C t");
  head.setups = {angles(Vector3d::UnitZ(), 1.0)};
  head.setups[0].options.set("body", std::string("tool"));
  expect_hand_figures(head);
}

TEST(RotaryPositioning, IsNoTestOfAnotherRotation) {
  Campaign campaign = table_campaign();
  campaign.setups = {angles(Vector3d::UnitX(), 1.0)};
  EXPECT_THAT(figures_of(campaign).rotary_lines, IsEmpty());
  EXPECT_THAT(sentences(figures_of(campaign).not_recognised),
              ElementsAre(HasSubstr("angles: C turns, but not")));
  campaign.setups = {angles(Vector3d::UnitZ(), 1.0)};
  campaign.setups[0].options.set("body", std::string("tool"));
  EXPECT_THAT(figures_of(campaign).rotary_lines, IsEmpty()) << "the tool does not turn";
  EXPECT_THAT(sentences(figures_of(campaign).not_recognised),
              ElementsAre(HasSubstr("angles: C turns, but not")));
  campaign.setups[0].readings.position[0][2] = 0.1;
  EXPECT_THAT(sentences(figures_of(campaign).not_recognised),
              ElementsAre("angles: more than one axis moves"));
  for (std::vector<double>& position : campaign.setups[0].readings.position)
    position.assign(position.size(), 0.0);
  campaign.setups[0].readings.position[0][2] = 0.1;
  EXPECT_THAT(figures_of(campaign).not_recognised, IsEmpty()) << "angles of a linear axis";
}

/// The targets 60, 0 and 300 deg, recorded within a turn, with the deviations of angles(): 300 deg comes
/// before 0.
TEST(RotaryPositioning, GoesOnOverTheEndOfATurn) {
  Campaign campaign = table_campaign();
  volcal::Setup setup = angles(Vector3d::UnitZ(), 1.0);
  for (double& at : setup.readings.position[index_of(AxisName::C)])
    at = 2.0 * kThirty * std::fmod(std::round(at / 0.1) + 4.0, 6.0);
  campaign.setups = {setup};
  expect_hand_figures(campaign);
}

TEST(RotaryPositioning, SaysWhatItsFiguresRestOn) {
  Campaign campaign = table_campaign();
  campaign.setups = {angles(Vector3d::UnitZ(), 1.0)};
  EXPECT_THAT(figures_of(campaign).rotary_lines[0].notes, IsEmpty());
  Readings& readings = campaign.setups[0].readings;
  readings.position[index_of(AxisName::C)][0] += 3e-6;
  EXPECT_THAT(sentences(figures_of(campaign).rotary_lines[0].notes),
              ElementsAre("recorded positions within 3.0 urad were taken as one target"));
  readings.position[index_of(AxisName::C)][0] -= 3e-6;
  readings.direction[index_of(AxisName::C)].assign(readings.size(), 1);
  for (const std::size_t row : {3U, 9U}) readings.direction[index_of(AxisName::C)][row] = -1;
  EXPECT_THAT(sentences(figures_of(campaign).rotary_lines[0].notes),
              ElementsAre("2 of 3 targets were met from one direction only"));
}

/// At rest for two hours: X 0, 2, 6 um; 100 mm lower 0, 1, 1 um, so that the tilt about Y is 0, 10, 50 urad.
TEST(DriftAtRest, OfTwoSpheresWithTemperatures) {
  Campaign campaign = table_campaign();
  campaign.machine.tools.push_back({"long", {0.0, 0.0, -0.1}, 0.0});
  for (const double share : {1.0, 0.0}) {
    volcal::Setup setup = one_setup(share > 0.0 ? "upper" : "lower", "r-test", 3);
    setup.tool = share > 0.0 ? 0 : 1;
    const double upper[] = {0.0, 2.0, 6.0}, lower[] = {0.0, 1.0, 1.0};
    for (int k = 0; k < 3; ++k) {
      read(setup, {}, {share > 0.0 ? upper[k] : lower[k], 0.0, 0.0});
      setup.readings.time.push_back(3600.0 * k);
      setup.readings.temperature["column"].push_back(20.0 + k);
    }
    campaign.setups.push_back(setup);
  }
  const auto tests = figures_of(campaign).drifts;
  ASSERT_EQ(tests.size(), 8u) << "three displacements each, two tilts";
  EXPECT_EQ(tests[0].setup, "upper");
  EXPECT_EQ(tests[0].quantity, "X");
  EXPECT_NEAR(micro(tests[0].figures.readings.range), 6.0, 1e-9);
  EXPECT_NEAR(micro(tests[0].figures.readings.first_hour), 2.0, 1e-9);
  EXPECT_NEAR(micro(tests[0].figures.readings.fastest_in_an_hour), 4.0, 1e-9);
  EXPECT_NEAR(micro(tests[0].figures.model.range), 3.0, 1e-9);
  ASSERT_EQ(tests[0].temperatures.size(), 1u);
  EXPECT_DOUBLE_EQ(tests[0].temperatures[0].high, 22.0);
  EXPECT_EQ(tests[6].quantity, "A");
  EXPECT_NEAR(micro(tests[6].figures.readings.range), 0.0, 1e-9);
  EXPECT_EQ(tests[7].quantity, "B");
  EXPECT_TRUE(tests[7].angle);
  EXPECT_NEAR(micro(tests[7].figures.readings.change), 50.0, 1e-6) << "the upper point goes towards +X";
}

TEST(DriftAtRest, IsNoDriftWithoutTimeOrInMotion) {
  Campaign campaign = table_campaign();
  volcal::Setup setup = one_setup("R", "r-test", 3);
  for (int k = 0; k < 3; ++k) read(setup, {}, {0.0, 0.0, 0.0});
  campaign.setups = {setup};
  EXPECT_THAT(figures_of(campaign).drifts, IsEmpty());
}

}  // namespace
}  // namespace volcal
