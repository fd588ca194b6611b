#include "volcal/sim/measurement/rotary_poses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "volcal/model/description/errors.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/machine/transforms.h"
#include "volcal/sim/measurement/instruments.h"
#include "volcal/sim/measurement/measurements.h"
#include "volcal/sim/study.h"

namespace volcal::sim {
namespace {

constexpr double kFullTurn = 2.0 * std::numbers::pi;

/// A table that tilts by 90 deg and turns, its axes meeting in the middle of the travel.
Machine tilting_table(const std::string& code = "w C' A' b X Y Z t") {
  Machine machine = machine_from_code(code, {{{-0.4, 0.4}, {-0.4, 0.4}, {-0.4, 0.4}}});
  for (Axis& axis : machine.axes) {
    if (axis.name != AxisName::A && axis.name != AxisName::B) continue;
    axis.travel_min = -0.25 * kFullTurn;
    axis.travel_max = 0.25 * kFullTurn;
  }
  return machine;
}

RTest r_test_at(const Eigen::Vector3d& sphere, std::vector<std::string> tools = {"short"}) {
  RTest settings;
  settings.poses.spheres = {{"S1", sphere}};
  settings.poses.tools = std::move(tools);
  settings.poses.grid.points = {{AxisName::A, 5}, {AxisName::C, 8}};
  return settings;
}

std::string plan_refusal(const MeasurementSettings& settings, const Machine& machine) {
  try {
    plan_setups({"", settings}, machine, 1);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RotaryPath, MeetsEveryCombinationThereAndBack) {
  const Machine machine = tilting_table();
  RotaryGrid grid;
  grid.points = {{AxisName::A, 3}, {AxisName::C, 4}};
  RandomStream random(1, "path");
  const auto path = rotary_path(machine, grid, random);
  ASSERT_EQ(path.size(), 12U);
  std::set<std::pair<double, double>> met;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const double a = path[i].position[index_of(AxisName::A)], c = path[i].position[index_of(AxisName::C)];
    met.insert({a, c});
    EXPECT_EQ(path[i].line, static_cast<int>(i / 4)) << "C, with more positions, moves fastest";
    if (i == 0) continue;
    const bool moves_a = a != path[i - 1].position[index_of(AxisName::A)];
    EXPECT_NE(moves_a, c != path[i - 1].position[index_of(AxisName::C)]) << "one axis at a time";
  }
  EXPECT_EQ(met.size(), 12U);
  EXPECT_EQ(met.begin()->first, -0.25 * kFullTurn);
  EXPECT_EQ(met.rbegin()->first, 0.25 * kFullTurn) << "both ends of a tilt";
  EXPECT_NEAR(met.rbegin()->second, 0.25 * kFullTurn, 1e-15) << "-180, -90, 0, 90 deg: a turn has one end";
  grid.bidirectional = true;
  const auto both = rotary_path(machine, grid, random);
  ASSERT_EQ(both.size(), 24U);
  EXPECT_EQ(both[23].position, both[0].position);
  EXPECT_EQ(both[23].line, 5);
  EXPECT_EQ(both[23].run, 1);
}

TEST(RotaryPath, OneAxisAfterAnotherLeavesTheOthersAtHome) {
  RotaryGrid grid;
  grid.combined = false;
  grid.range = {{AxisName::A, {-0.5, 0.25}}};
  RandomStream random(1, "path");
  const auto path = rotary_path(tilting_table(), grid, random);
  ASSERT_EQ(path.size(), 12U + 7U) << "twelve positions of a turn, seven of a tilt";
  for (const CommandedPoint& point : path) {
    const double a = point.position[index_of(AxisName::A)], c = point.position[index_of(AxisName::C)];
    EXPECT_EQ(point.line == 0 ? a : c, 0.0);
    EXPECT_GE(a, -0.5);
    EXPECT_LE(a, 0.25);
  }
  EXPECT_EQ(path[12].position[index_of(AxisName::A)], -0.5);
  EXPECT_EQ(path[18].position[index_of(AxisName::A)], 0.25);
}

TEST(RTestPlan, KeepsTheToolPointOnTheSphereWithinTravel) {
  for (const char* code :
       {"w C' A' Y' b X Z t", "w X' b Y Z C B t", "w C' X' b Y Z B t", "w C' B' b X Y Z t"}) {
    const Machine machine = tilting_table(code);
    RTest settings = r_test_at({0.05, -0.03, 0.02}, {"short", "side_x"});
    settings.poses.grid.points.clear();
    const TruthMachine nominal(machine);
    const auto plans = plan_setups({"", settings}, machine, 1);
    ASSERT_EQ(plans.size(), 2U);
    for (const SetupPlan& plan : plans) {
      EXPECT_EQ(plan.points.size(), 84U) << code;
      EXPECT_EQ(plan.poses_left_out, 0U) << code;
      EXPECT_EQ(plan.unseen.size(), plan.points.size());
      for (const auto* points : {&plan.points, &plan.unseen}) {
        for (const CommandedPoint& point : *points) {
          MachineState state;
          state.position = point.position;
          const Eigen::Vector3d tip = nominal.nominal_point(state, machine.tools[plan.tool].offset);
          EXPECT_LT((tip - Eigen::Vector3d(0.05, -0.03, 0.02)).norm(), 1e-14) << code;
          for (const Axis& axis : machine.axes) {
            EXPECT_GE(point.position[index_of(axis.name)], axis.travel_min - 1e-9);
            EXPECT_LE(point.position[index_of(axis.name)], axis.travel_max + 1e-9);
          }
        }
      }
      bool between = false;
      for (std::size_t i = 0; i < plan.points.size(); ++i)
        between = between || plan.unseen[i].position != plan.points[i].position;
      EXPECT_TRUE(between) << "unseen positions are others";
    }
    EXPECT_EQ(plans[0].truth.sphere, plans[1].truth.sphere) << "one sphere, two tools";
    EXPECT_GT(plans[0].truth.sphere.norm(), 1e-6);
  }
}

TEST(RTestPlan, DirectionsAreThoseOfTheMovesBetweenPoses) {
  const Machine machine = tilting_table();
  const SetupPlan plan = plan_setups({"", r_test_at({0.05, 0.0, 0.0})}, machine, 1).front();
  for (std::size_t i = 1; i < plan.points.size(); ++i) {
    for (const Axis& axis : machine.axes) {
      const std::size_t k = index_of(axis.name);
      const double move = plan.points[i].position[k] - plan.points[i - 1].position[k];
      if (std::abs(move) < 1e-9) continue;
      EXPECT_EQ(plan.points[i].direction[k], move > 0.0 ? 1 : -1);
    }
  }
}

TEST(RTestPlan, LeavesOutPosesBeyondTheTravelAndSaysHowMany) {
  Machine machine = tilting_table();
  machine.axes[4].travel_max = 0.1;  // Z; at A = +-90 deg the sphere is 0.3 m above or below the centre
  ASSERT_EQ(machine.axes[4].name, AxisName::Z);
  // Z = height of the sphere + 0.15 m: the sphere may be 50 mm below the centre at most.
  const RTest settings = r_test_at({0.1, 0.0, -0.1});
  const SetupPlan plan = plan_setups({"", settings}, machine, 1).front();
  EXPECT_GT(plan.poses_left_out, 5U);
  EXPECT_EQ(plan.poses_left_out + plan.points.size(), 40U);
  EXPECT_EQ(plan.left_out_by, "Z");
}

TEST(RTestPlan, RefusesWhatLeavesTooFewPoses) {
  const Machine machine = tilting_table();
  const std::string far = plan_refusal(r_test_at({0.8, 0.0, 0.0}), machine);
  EXPECT_THAT(far, testing::HasSubstr("of 40 poses of setup rtest_S1_short"));
  EXPECT_THAT(far, testing::HasSubstr("put the sphere nearer to the rotary axes"));
  EXPECT_THAT(plan_refusal(RTest{}, machine), testing::HasSubstr("no sphere is listed"));
  EXPECT_THAT(plan_refusal(r_test_at({0, 0, 0}, {"none"}), machine),
              testing::HasSubstr("there is no tool \"none\""));
  EXPECT_THAT(plan_refusal(r_test_at({0, 0, 0}), reference_machines()[0]),
              testing::HasSubstr("the machine has no rotary axis"));
  RTest beyond = r_test_at({0, 0, 0});
  beyond.poses.grid.range = {{AxisName::A, {-2.0, 2.0}}};
  EXPECT_THAT(plan_refusal(beyond, machine), testing::HasSubstr("range_deg of A is not within its travel"));
  RTest other = r_test_at({0, 0, 0});
  other.poses.grid.points = {{AxisName::B, 5}};
  EXPECT_THAT(plan_refusal(other, machine), testing::HasSubstr("B is not a rotary axis of the machine"));
  RTest twice = r_test_at({0, 0, 0});
  twice.poses.spheres.push_back(twice.poses.spheres.front());
  EXPECT_THAT(plan_refusal(twice, machine), testing::HasSubstr("two spheres are called S1"));
  ProbedSphere kind;
  kind.poses = r_test_at({0, 0, 0}).poses;
  kind.contacts = true;
  kind.kinds = {"Q"};
  EXPECT_THAT(plan_refusal(kind, machine), testing::HasSubstr("\"Q\" is not a kind of contact"));
}

TEST(RTestPlan, AnAxisThatCannotBeFollowedIsLeftOut) {
  // X' outward of C': at C = +-90 deg X and Y move the tool point along one line.
  const Machine machine = tilting_table("w X' C' b Y Z t");
  RTest settings = r_test_at({0.0, 0.05, 0.0});
  settings.poses.grid.points = {{AxisName::C, 8}};
  const SetupPlan plan = plan_setups({"", settings}, machine, 1).front();
  EXPECT_EQ(plan.poses_left_out, 2U);
  EXPECT_EQ(plan.left_out_by, "XYZ");
}

TEST(BallBarPoses, TheBallStaysAtTheLengthOfTheBar) {
  const Machine machine = tilting_table();
  BallBarPoses settings;
  settings.poses = r_test_at({0.02, 0.03, 0.0}).poses;
  settings.bar.noise = {};
  settings.bar.length_error = 2e-6;
  const auto plans = plan_setups({"", settings}, machine, 1);
  ASSERT_EQ(plans.size(), 3U);
  const TruthMachine truth(machine);
  const Environment environment;
  std::vector<Eigen::Vector3d> tools;
  for (const Tool& tool : machine.tools) tools.push_back(tool.offset);
  for (const SetupPlan& plan : plans) {
    const volcal::Setup setup = measure(plan, {truth, environment, tools, 1, false, true}, 0.0);
    EXPECT_EQ(setup.instrument, "ball-bar");
    for (const double length : setup.readings.value[0])
      EXPECT_NEAR(length, 0.1 + plan.truth.length_error, 1e-13);
    // The direction stands still in the axes of the machine.
    for (const CommandedPoint& point : plan.points) {
      MachineState state;
      state.position = point.position;
      const Eigen::Vector3d bar_w = truth.nominal_point(state, tools[0]) - Eigen::Vector3d(0.02, 0.03, 0.0);
      const Eigen::Vector3d bar_b = truth.nominal_bed_axes(state).transpose() * bar_w;
      const auto along = static_cast<int>(std::string("xyz").find(plan.name.back()));
      EXPECT_NEAR(bar_b[along], 0.1, 1e-13) << plan.name;
    }
  }
}

TEST(RotaryTracking, MovesRotaryAxesAtRandomOrOnAGridThereAndBack) {
  const Machine machine = tilting_table();
  for (const RotaryMotion motion : {RotaryMotion::Random, RotaryMotion::Grid}) {
    Tracking settings;
    settings.grid = {3, 3, 2};
    settings.rotary = motion;
    settings.rotary_grid.points = {{AxisName::A, 3}, {AxisName::C, 4}};
    const SetupPlan plan = plan_setups({"", settings}, machine, 1).front();
    ASSERT_EQ(plan.points.size(), 36U);
    std::set<double> tilts;
    for (std::size_t i = 0; i < 18; ++i) {
      const CommandedPoint& forward = plan.points[i];
      const CommandedPoint& back = plan.points[35 - i];
      EXPECT_EQ(forward.position, back.position);
      tilts.insert(forward.position[index_of(AxisName::A)]);
      const std::size_t c = index_of(AxisName::C);
      if (i > 0 && forward.position[c] != plan.points[i - 1].position[c]) {
        EXPECT_EQ(forward.direction[c], forward.position[c] > plan.points[i - 1].position[c] ? 1 : -1);
      }
      EXPECT_EQ(forward.direction[c], -back.direction[c]);
    }
    EXPECT_EQ(tilts.size(), motion == RotaryMotion::Grid ? 3U : 18U);
    EXPECT_EQ(plan.unseen.size(), plan.points.size());
  }
  Tracking settings;
  settings.rotary = RotaryMotion::Random;
  EXPECT_THAT(plan_refusal(settings, reference_machines()[0]), testing::HasSubstr("has no rotary axis"));
}

TEST(RotaryStudy, ValidatesAtRotaryPosesWhereTheCampaignMovesThem) {
  Study study;
  study.machine = tilting_table();
  study.validation.points = 50;
  study.measurements = {{"", PointGrid{}}};
  const std::size_t c = index_of(AxisName::C);
  const SimulatedCampaign at_home = simulate(study);
  for (const double position : at_home.validation.setups[0].readings.position[c]) EXPECT_EQ(position, 0.0);
  PointGrid rotary;
  rotary.rotary = RotaryMotion::Grid;
  study.measurements = {{"", rotary}};
  const SimulatedCampaign simulated = simulate(study);
  std::set<double> positions(simulated.validation.setups[0].readings.position[c].begin(),
                             simulated.validation.setups[0].readings.position[c].end());
  EXPECT_EQ(positions.size(), 50U);
  std::set<double> measured(simulated.campaign.setups[0].readings.position[c].begin(),
                            simulated.campaign.setups[0].readings.position[c].end());
  EXPECT_EQ(measured.size(), 12U);
}

TEST(RotaryStudy, HiddenEffectsOnSingleContactsCountAlongTheNormal) {
  Study study;
  study.machine = tilting_table();
  study.truth.perfect = true;
  ProbedSphere probing;
  probing.poses = r_test_at({0.05, 0.0, 0.0}).poses;
  probing.poses.grid.bidirectional = true;
  probing.contacts = true;
  probing.kinds = {"W"};
  study.measurements = {{"", probing}};
  HiddenEffect reversal;
  reversal.kind = "reversal";
  reversal.options.set("symbol", std::string("EZZ"));
  reversal.amplitude = 4e-6;
  study.hidden = {reversal};
  // The contact is along the machine's z, where the tool is half the reversal up or down: 2 um at each
  // reading.
  const SimulatedCampaign simulated = simulate(study);
  ASSERT_EQ(simulated.hidden.size(), 1U);
  EXPECT_NEAR(simulated.hidden[0].rms, 2e-6, 1e-9);
  EXPECT_EQ(simulated.campaign.setups[0].readings.value.size(), 1U);
  EXPECT_EQ(simulated.campaign.setups[0].readings.given.size(), 6U);
}

}  // namespace
}  // namespace volcal::sim
