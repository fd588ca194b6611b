/// Orders of lines, unseen positions, feeds, revisits.

#include "volcal/sim/measurement/paths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal::sim {
namespace {

using Position = std::array<double, kAxisCount>;

TEST(PointsBetween, LieOnTheWayAndStayInTheirLines) {
  const Machine machine = reference_machines()[0];
  const auto path =
      straight_path(at_fraction(machine, {0, 0.5, 0.5}), at_fraction(machine, {1, 0.5, 0.5}), 11, 2, true);
  RandomStream random(1, "between");
  const auto between = points_between(path, random);
  ASSERT_EQ(between.size(), path.size());
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_EQ(between[i].line, path[i].line);
    EXPECT_EQ(between[i].direction, path[i].direction);
    const bool last = i + 1 == path.size() || path[i + 1].line != path[i].line;
    const double a = path[last ? i - 1 : i].position[0];
    const double b = path[last ? i : i + 1].position[0];
    EXPECT_GT(between[i].position[0], std::min(a, b) + 0.01);  // 0.1 m apart, at least 15 % away
    EXPECT_LT(between[i].position[0], std::max(a, b) - 0.01);
    EXPECT_NEAR(between[i].position[1], path[i].position[1], 1e-12);
  }
}

TEST(UnseenPositions, AreElsewhereButOfTheSameLines) {
  Study study;
  study.machine = reference_machines()[0];
  study.unseen = true;
  Tracking tracer;
  tracer.grid = {4, 3, 3};
  study.measurements = {{"", tracer}, {"", BallBarCircles{}}, {"", AxisLines{}}, {"", PointGrid{}}};
  const SimulatedCampaign simulated = simulate(study);
  ASSERT_EQ(simulated.unseen.setups.size(), simulated.campaign.setups.size());
  for (std::size_t i = 0; i < simulated.unseen.setups.size(); ++i) {
    const Readings& seen = simulated.campaign.setups[i].readings;
    const Readings& unseen = simulated.unseen.setups[i].readings;
    SCOPED_TRACE(simulated.campaign.setups[i].name);
    EXPECT_EQ(seen.line, unseen.line);
    EXPECT_EQ(seen.time, unseen.time);
    std::size_t same = 0;
    for (std::size_t row = 0; row < seen.size(); ++row) {
      bool equal = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const Axis& axis = study.machine.axes[k];
        EXPECT_GE(unseen.position[k][row], axis.travel_min - 1e-12);
        EXPECT_LE(unseen.position[k][row], axis.travel_max + 1e-12);
        equal = equal && seen.position[k][row] == unseen.position[k][row];
      }
      same += equal ? 1 : 0;
    }
    EXPECT_LE(same, seen.size() / 20);  // corners of the travel, where both are clipped
    // Nothing is hidden: with and without are the same, and free of noise.
    EXPECT_EQ(simulated.unseen.setups[i].readings.value,
              simulated.unseen_without_hidden.setups[i].readings.value);
  }
}

TEST(UnseenPositions, ShareStationAndDeadPathWithTheCampaign) {
  Study study;
  study.machine = reference_machines()[0];
  study.truth.perfect = true;
  study.unseen = true;
  study.measurements = {{"", Tracking{}}};
  const SimulatedCampaign simulated = simulate(study);
  const TruthMachine nominal(study.machine);
  for (std::size_t i = 0; i < simulated.plans.size(); ++i) {
    const SetupPlan& plan = simulated.plans[i];
    const Readings& unseen = simulated.unseen.setups[i].readings;
    for (std::size_t row = 0; row < unseen.size(); ++row) {
      MachineState state;
      for (std::size_t k = 0; k < 3; ++k) state.position[k] = unseen.position[k][row];
      const Eigen::Vector3d point = nominal.point(state, study.machine.tools[plan.tool].offset);
      EXPECT_NEAR(unseen.value[0][row], (point - plan.truth.station).norm() - plan.truth.dead_path, 1e-13);
    }
  }
}

TEST(ShuffledLines, AreTheSameLinesInAnotherOrder) {
  Study study;
  study.machine = reference_machines()[0];
  Tracking tracer;
  tracer.grid = {5, 4, 3};
  study.measurements = {{"", tracer}};
  const SimulatedCampaign sorted = simulate(study);
  study.measurements[0].shuffled = true;
  const SimulatedCampaign shuffled = simulate(study);
  std::set<std::vector<std::int32_t>> orders;
  for (std::size_t i = 0; i < sorted.plans.size(); ++i) {
    const auto by_line = [](const SetupPlan& plan) {
      std::map<std::int32_t, std::vector<std::pair<Position, std::array<std::int8_t, kAxisCount>>>> lines;
      for (const CommandedPoint& point : plan.points) {
        lines[point.line].emplace_back(point.position, point.direction);
      }
      return lines;
    };
    EXPECT_EQ(by_line(sorted.plans[i]), by_line(shuffled.plans[i]));
    EXPECT_FALSE(std::ranges::is_sorted(shuffled.campaign.setups[i].readings.line));
    EXPECT_EQ(shuffled.plans[i].truth.dead_path, sorted.plans[i].truth.dead_path);
    orders.insert(shuffled.campaign.setups[i].readings.line);
  }
  EXPECT_EQ(orders.size(), sorted.plans.size());
}

TEST(Revisits, GoThroughTheRunsAgainAtTheSameStations) {
  Study study;
  study.machine = reference_machines()[0];
  Tracking tracer;
  tracer.grid = {3, 3, 3};
  tracer.revisits = 1;
  study.measurements = {{"", tracer}};
  const SimulatedCampaign simulated = simulate(study);
  ASSERT_EQ(simulated.plans.size(), 16U);
  for (std::size_t i = 0; i < 8; ++i) {
    const SetupPlan& first = simulated.plans[i];
    const SetupPlan& again = simulated.plans[i + 8];
    EXPECT_EQ(again.name, first.name + "_2");
    EXPECT_EQ(again.truth.station, first.truth.station);
    EXPECT_EQ(again.options.text("station"), first.options.text("station"));
    EXPECT_NE(again.points[0].position, first.points[0].position);  // jittered anew
    EXPECT_GT(simulated.campaign.setups[i + 8].readings.time.front(),
              simulated.campaign.setups[7].readings.time.back());
  }
}

TEST(BallBarFeed, GivesVelocitiesAndTheClock) {
  Study study;
  study.machine = reference_machines()[0];
  BallBarCircles circles;
  circles.planes = {"XY"};
  circles.radius = 0.1;
  circles.points_per_turn = 100;
  circles.feed = 0.05;
  circles.records_feed = true;
  study.measurements = {{"", circles}};
  const SimulatedCampaign simulated = simulate(study);
  const SetupPlan& plan = simulated.plans[0];
  const double step = 2.0 * 3.14159265358979323846 * 0.1 / 100.0;
  EXPECT_NEAR(plan.seconds_per_reading, step / 0.05, 1e-12);
  for (std::size_t i = 0; i + 1 < plan.points.size(); ++i) {
    const CommandedPoint& point = plan.points[i];
    EXPECT_NEAR(simulated.campaign.setups[0].readings.feed[i], 0.05, 1e-12);
    if (plan.points[i + 1].line != point.line) continue;
    for (std::size_t k = 0; k < 2; ++k) {  // chords are the velocity to half a step of the angle
      const double chord = (plan.points[i + 1].position[k] - point.position[k]) / plan.seconds_per_reading;
      EXPECT_NEAR(point.velocity[k], chord, 0.05 * 0.04);
    }
  }
}

}  // namespace
}  // namespace volcal::sim
