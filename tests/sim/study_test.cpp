#include "volcal/sim/study.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "volcal/model/description/errors.h"
#include "volcal/sim/machine/datum.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/measurement/paths.h"

namespace volcal::sim {
namespace {

Study full_study(std::uint64_t seed) {
  Study study;
  study.machine = reference_machines()[1];
  study.seed = seed;
  study.environment.channels = {{.name = "air", .start = 20.5, .drift = 1e-5, .amplitude = 0.3}};
  study.machine.axes[0].expansion = ScaleExpansion{11e-6, 1e-6, "air"};
  study.machine.tools[1].offset_sigma = 1e-6;
  Tracking tracker;
  tracker.instrument = "laser-tracker";
  tracker.grid = {4, 3, 3};
  tracker.length_scale_sigma = 0.5e-6;
  Diagonals faces;
  faces.kind = Diagonals::Kind::Face;
  Diagonals steps;
  steps.steps = true;
  study.measurements = {
      {"", Tracking{}}, {"tracker", tracker}, {"", BallBarCircles{}}, {"", Diagonals{}},
      {"", faces},      {"", steps},          {"", AxisLines{}},      {"", StraightnessLines{}},
      {"", Squares{}},  {"", AngleLines{}},   {"", PointGrid{}}};
  return study;
}

const volcal::Setup& setup_named(const Campaign& campaign, const std::string& name) {
  for (const volcal::Setup& setup : campaign.setups) {
    if (setup.name == name) return setup;
  }
  throw std::out_of_range("no setup " + name);
}

void expect_same_readings(const Campaign& a, const Campaign& b) {
  ASSERT_EQ(a.setups.size(), b.setups.size());
  for (std::size_t i = 0; i < a.setups.size(); ++i) {
    EXPECT_EQ(a.setups[i].readings.value, b.setups[i].readings.value) << a.setups[i].name;
    EXPECT_EQ(a.setups[i].readings.position, b.setups[i].readings.position) << a.setups[i].name;
    EXPECT_EQ(a.setups[i].options.all(), b.setups[i].options.all()) << a.setups[i].name;
  }
}

TEST(Simulate, RepeatsToTheBit) {
  const SimulatedCampaign first = simulate(full_study(5));
  const SimulatedCampaign second = simulate(full_study(5));
  expect_same_readings(first.campaign, second.campaign);
  expect_same_readings(first.validation, second.validation);
  const SimulatedCampaign other = simulate(full_study(6));
  EXPECT_NE(first.campaign.setups[0].readings.value, other.campaign.setups[0].readings.value);
}

TEST(Simulate, ASetupDoesNotDependOnTheOthers) {
  Study few = full_study(5);
  few.environment.channels.clear();  // temperatures depend on the clock
  few.machine.axes[0].expansion.reset();
  Study fewer = few;
  fewer.measurements.erase(fewer.measurements.begin());
  const SimulatedCampaign all = simulate(few);
  const SimulatedCampaign some = simulate(fewer);
  for (const volcal::Setup& setup : some.campaign.setups) {
    EXPECT_EQ(setup.readings.value, setup_named(all.campaign, setup.name).readings.value) << setup.name;
  }
}

TEST(Simulate, EverySetupIsFilledAndWithinTravel) {
  const Study study = full_study(2);
  const SimulatedCampaign simulated = simulate(study);
  std::set<std::string> instruments;
  for (const volcal::Setup& setup : simulated.campaign.setups) {
    instruments.insert(setup.instrument);
    ASSERT_GT(setup.readings.size(), 0U);
    EXPECT_TRUE(setup.has_noise);
    for (const Axis& axis : study.machine.axes) {
      const auto& position = setup.readings.position[index_of(axis.name)];
      ASSERT_EQ(position.size(), setup.readings.size());
      for (const double q : position) {
        EXPECT_GE(q, axis.travel_min - 1e-12) << setup.name;
        EXPECT_LE(q, axis.travel_max + 1e-12) << setup.name;
      }
    }
    for (const auto& channel : setup.readings.value) {
      ASSERT_EQ(channel.size(), setup.readings.size());
      for (const double value : channel) EXPECT_TRUE(std::isfinite(value));
    }
  }
  EXPECT_EQ(instruments, (std::set<std::string>{"angle", "ball-bar", "displacement", "laser-tracer",
                                                "laser-tracker", "straightness", "volumetric-points"}));
}

TEST(Simulate, StandardTracerCampaignHas6048ReadingsFromBothDirections) {
  Study study;
  study.machine = reference_machines()[0];
  study.measurements = {{"", Tracking{}}};
  const SimulatedCampaign simulated = simulate(study);
  ASSERT_EQ(simulated.campaign.setups.size(), 8U);
  EXPECT_EQ(simulated.campaign.reading_count(), 6048U);
  std::set<std::size_t> tools;
  for (const volcal::Setup& setup : simulated.campaign.setups) {
    tools.insert(setup.tool);
    const Readings& r = setup.readings;
    ASSERT_EQ(r.size(), 756U);
    for (std::size_t i = 0; i < r.size(); ++i) {
      const std::size_t back = r.size() - 1 - i;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(r.position[axis][i], r.position[axis][back]);
        EXPECT_EQ(r.direction[axis][i], -r.direction[axis][back]);
      }
    }
  }
  EXPECT_EQ(tools.size(), 3U);
}

TEST(Simulate, PerfectMachineGivesWhatTheNominalGeometrySays) {
  Study study;
  study.machine = reference_machines()[3];
  study.truth.perfect = true;
  BallBarCircles circles;
  circles.length_error = 0.0;
  circles.noise = {};
  Diagonals diagonals;
  diagonals.offset_spread = 0.0;
  diagonals.noise = {};
  study.measurements = {{"", circles}, {"", diagonals}};
  const SimulatedCampaign simulated = simulate(study);
  for (const double length : setup_named(simulated.campaign, "ballbar_XY").readings.value[0]) {
    EXPECT_NEAR(length, 0.45 * 0.33, 1e-12);  // the usual 150 mm do not fit into 330 mm of travel
  }
  const std::vector<double> diagonal = setup_named(simulated.campaign, "body_ppp").readings.value[0];
  ASSERT_EQ(diagonal.size(), 42U);
  EXPECT_NEAR(diagonal[20], std::sqrt(0.25 + 0.16 + 0.33 * 0.33), 1e-12);
  for (const std::vector<double>& channel : simulated.validation.setups[0].readings.value) {
    for (const double value : channel) EXPECT_EQ(value, 0.0);
  }
}

TEST(Simulate, BallBarRunsClockwiseThenCounterClockwise) {
  const CommandedPoint centre = at_fraction(reference_machines()[0], {0.5, 0.5, 0.5});
  const auto path = circular_path(centre, AxisName::X, AxisName::Y, 0.1, 360);
  ASSERT_EQ(path.size(), 722U);
  EXPECT_EQ(path[90].run, 0);
  EXPECT_NEAR(path[90].position[1] - centre.position[1], -0.1, 1e-15);  // clockwise: first towards -y
  EXPECT_EQ(path[45].direction[0], -1);
  EXPECT_EQ(path[45].direction[1], -1);
  EXPECT_EQ(path[361 + 45].run, 1);
  EXPECT_EQ(path[361 + 45].direction[0], -1);
  EXPECT_EQ(path[361 + 45].direction[1], 1);
  for (const CommandedPoint& point : path) {
    EXPECT_NEAR(std::hypot(point.position[0] - centre.position[0], point.position[1] - centre.position[1]),
                0.1, 1e-15);
    EXPECT_NE(point.direction[0], 0);
  }
}

/// A quarter of a circle in YZ, 100 mm about a centre that no share of the travel gives.
BallBarCircles quarter_circle(const Machine& machine) {
  const CommandedPoint centre = at_fraction(machine, {0.31, 0.42, 0.53});
  BallBarCircles::Run run{"P1_quarter", {}, machine.tools.back().name, {}};
  run.centre_w = TruthMachine(machine).nominal_point({centre.position, centre.direction, 0.0, {}},
                                                     machine.tools.back().offset);
  for (int i = 0; i <= 9; ++i) {
    CommandedPoint point = centre;
    point.position[1] += 0.1 * std::cos(i * 0.1745329251994330);
    point.position[2] += 0.1 * std::sin(i * 0.1745329251994330);
    point.direction = {1, -1, 1};
    point.line = 7;
    run.points.push_back(point);
  }
  BallBarCircles circles;
  circles.runs = {run};
  circles.noise = {};
  circles.length_error = 0.0;
  circles.length_sigma = 0.0;
  return circles;
}

TEST(Simulate, BallBarRunsAreTakenAsGiven) {
  Study study;
  study.machine = reference_machines()[0];
  study.truth.perfect = true;
  const BallBarCircles circles = quarter_circle(study.machine);
  const BallBarCircles::Run& run = circles.runs.front();
  study.measurements = {{"bar", circles}};
  const SimulatedCampaign simulated = simulate(study);
  ASSERT_EQ(simulated.campaign.setups.size(), 1U);  // no circles besides
  const volcal::Setup& setup = simulated.campaign.setups.front();
  EXPECT_EQ(setup.name, "bar_P1_quarter");
  EXPECT_EQ(setup.instrument, "ball-bar");
  EXPECT_EQ(setup.tool, study.machine.tools.size() - 1);
  EXPECT_LT((*setup.options.vector("centre") - run.centre_w).norm(), 200e-6);  // 20 um a component
  EXPECT_EQ(*setup.options.number("length_sigma"), 0.0);
  ASSERT_EQ(setup.readings.size(), run.points.size());
  for (std::size_t i = 0; i < run.points.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(setup.readings.position[k][i], run.points[i].position[k]);
      EXPECT_EQ(setup.readings.direction[k][i], run.points[i].direction[k]);
    }
    EXPECT_EQ(setup.readings.line[i], 7);
    EXPECT_NEAR(setup.readings.value[0][i], 0.1, 1e-12);
  }
  // 10 degrees in 0.1 s: 17.45 mm along the arc, the chord a little less.
  const CommandedPoint& middle = simulated.plans.front().points[5];
  EXPECT_NEAR(std::hypot(middle.velocity[1], middle.velocity[2]), 0.1745, 2e-3);
}

TEST(Simulate, BallBarRunsStayOnASphere) {
  Study study;
  study.machine = reference_machines()[0];
  BallBarCircles circles = quarter_circle(study.machine);
  const auto problem = [&] {
    study.measurements = {{"", circles}};
    try {
      simulate(study);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(problem(), "");
  circles.runs[0].place = {"study.toml", 12};
  circles.runs[0].points[3].position[1] += 0.005;
  EXPECT_NE(problem().find("study.toml:12: run P1_quarter has positions from 100 to 104 mm"),
            std::string::npos)
      << problem();
  circles.runs[0].points.clear();
  EXPECT_NE(problem().find("has no positions"), std::string::npos) << problem();
  circles.runs[0].tool = "longest";
  EXPECT_NE(problem().find("study.toml:12"), std::string::npos) << problem();
}

TEST(Simulate, StepDiagonalMovesOneAxisAtATime) {
  const Machine machine = reference_machines()[0];
  const auto path = step_path(at_fraction(machine, {0, 1, 0}), at_fraction(machine, {1, 0, 1}), 5, 1, true);
  ASSERT_EQ(path.size(), 32U);
  EXPECT_NEAR(path[1].position[0], 0.2, 1e-15);
  EXPECT_NEAR(path[1].position[1], 0.6, 1e-15);
  EXPECT_NEAR(path[2].position[1], 0.48, 1e-15);
  EXPECT_NEAR(path[3].position[2], 0.1, 1e-15);
  EXPECT_EQ(path[1].direction[1], -1);
  EXPECT_EQ(path[17].direction[1], 1);
  EXPECT_EQ(path[15].position, path[16].position);
}

TEST(Simulate, NuisanceTruthDiffersFromTheCampaignsGuess) {
  Study study;
  study.machine = reference_machines()[0];
  Tracking tracking;
  tracking.station_guess_error = 10e-3;
  study.measurements = {{"", tracking}, {"", BallBarCircles{}}};
  const SimulatedCampaign simulated = simulate(study);
  for (std::size_t i = 0; i < simulated.plans.size(); ++i) {
    const Options& stated = simulated.campaign.setups[i].options;
    const InstrumentTruth& truth = simulated.plans[i].truth;
    if (simulated.plans[i].instrument == "laser-tracer") {
      const double off = (*stated.vector("station") - truth.station).norm();
      EXPECT_GT(off, 0.5e-3);
      EXPECT_LT(off, 50e-3);
    } else {
      const double off = (*stated.vector("centre") - truth.centre).norm();
      EXPECT_GT(off, 1e-6);
      EXPECT_LT(off, 100e-6);
    }
  }
}

TEST(Simulate, ExpansionIsDrawnFromItsStatedUncertainty) {
  Study study;
  study.machine = reference_machines()[0];
  study.truth.perfect = true;
  study.environment.channels = {{.name = "X", .start = 22.0}};
  study.machine.axes[0].expansion = ScaleExpansion{10e-6, 0.0, "X"};
  MachineState state;
  state.position[0] = 0.5;
  state.temperature["X"] = 22.0;
  const ErrorSymbol exx = *ErrorSymbol::parse("EXX");
  EXPECT_NEAR(true_machine(study).error(exx, state), 10e-6, 1e-15);
  study.machine.axes[0].expansion->per_kelvin_sigma = 1e-6;
  EXPECT_NE(true_machine(study).error(exx, state), 10e-6);
  study.truth.expansions[AxisName::X] = {7e-6, 0.0, "X"};
  EXPECT_NEAR(true_machine(study).error(exx, state), 7e-6, 1e-15);
  const SimulatedCampaign simulated = simulate(study);
  for (const double value : simulated.validation.setups[0].readings.value[0]) EXPECT_EQ(value, 0.0);
}

TEST(Simulate, NamesWhatMakesNoSense) {
  Study study;
  study.machine = reference_machines()[0];
  BallBarCircles circles;
  circles.radius = 0.4;
  study.measurements = {{"", circles}};
  EXPECT_THROW(simulate(study), InputError);
  study.measurements = {{"", Diagonals{}}, {"", Diagonals{}}};
  EXPECT_THROW(simulate(study), InputError);
  AxisLines lines;
  lines.tool = "long";
  study.measurements = {{"", lines}};
  EXPECT_THROW(simulate(study), InputError);
  study.measurements = {};
  study.truth.expansions[AxisName::X] = {7e-6, 0.0, "X"};
  EXPECT_THROW(simulate(study), InputError);
}

TEST(RandomTruth, VolumetricErrorIsThatOfOrdinaryMachines) {
  for (const Machine& machine : reference_machines()) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Study study;
      study.machine = machine;
      study.seed = seed;
      study.validation.points = 400;
      const SimulatedCampaign simulated = simulate(study);
      const Readings& r = simulated.validation.setups[0].readings;
      std::vector<Eigen::Vector3d> point;
      std::vector<Eigen::Vector3d> error;
      for (std::size_t i = 0; i < r.size(); ++i) {
        point.emplace_back(r.position[0][i], r.position[1][i], r.position[2][i]);
        error.emplace_back(r.value[0][i], r.value[1][i], r.value[2][i]);
      }
      const double rms = rms_after_alignment(point, error);
      EXPECT_GT(rms, 14e-6) << machine.name << " seed " << seed;
      EXPECT_LT(rms, 23e-6) << machine.name << " seed " << seed;
    }
  }
}

TEST(RandomTruth, FunctionsAreZeroAtHomeAndTheFrameIsNotTurned) {
  for (const Machine& machine : reference_machines()) {
    const TruthMachine truth = random_truth(machine, 11);
    const TruthInDatum tables(truth);
    EXPECT_LT(tables.frame_rotation().norm(), 1e-15);
    double moved = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double location = truth.location(machine.datum.squareness()[i]);
      EXPECT_GT(std::abs(location), 1e-6);
      EXPECT_LT(std::abs(location), 100e-6);
      moved += std::abs(tables.squareness()[i] - location);
    }
    EXPECT_GT(moved, 1e-8);
    for (const Axis& axis : machine.axes) {
      for (const Component component : kAllComponents) {
        EXPECT_NEAR(truth.function_value({component, axis.name}, axis.home), 0.0, 1e-20);
      }
    }
  }
}

TEST(RandomTruth, RotaryAxesGetMotionAndLocationErrors) {
  const TruthMachine truth =
      random_truth(machine_from_code("w C' A' b X Y Z t", {{{0, 1}, {0, 1}, {0, 1}}}), 3);
  EXPECT_NE(truth.function_value(*ErrorSymbol::parse("EXC"), 1.0), 0.0);
  EXPECT_NE(truth.location(*LocationSymbol::parse("EB0A")), 0.0);
  EXPECT_LT(std::abs(truth.location(*LocationSymbol::parse("EX0C"))), 100e-6);
}

}  // namespace
}  // namespace volcal::sim
