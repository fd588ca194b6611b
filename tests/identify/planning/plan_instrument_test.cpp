/// What the planner knows of its instruments, by hand: where a circle fits, what is reached, what is counted.

#include "volcal/identify/planning/plan_instrument.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "tests/support/five_axis.h"
#include "volcal/identify/planning/path_choice.h"
#include "volcal/identify/planning/plan_search.h"
#include "volcal/identify/planning/registry.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/sim/machine/reference_machines.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;

/// 1000 x 600 x 500 mm, the tool 150 mm below the spindle's reference point: functional points from
/// (0, 0, -150) to (1000, 600, 350) mm. A bar of 100 mm, a spindle that is in nobody's way.
PlanSettings one_bar() {
  PlanSettings settings;
  settings.machine = sim::reference_machines().front();
  settings.machine.tools.resize(1);
  settings.instrument = "ball-bar";
  settings.bar = {0.1, 0.5e-6};
  settings.surroundings.spindle_radius = 0.0;
  settings.costs.reading = 0.1;
  settings.budget.stations = 2;
  settings.budget.readings = 1000;
  settings.model.default_function.basis = "legendre";
  settings.model.default_function.degree = 2;
  settings.threads = 2;
  return settings;
}

/// Positions of every plane's path about a place.
std::map<std::string, std::size_t> paths_about(const PlanSettings& settings, const Eigen::Vector3d& place_w) {
  std::map<std::string, std::size_t> counts;
  for (const PlanRun& run : LineOfSight(settings).candidate_runs(place_w, 0, 0, {}))
    counts[run.part] = run.positions.size();
  return counts;
}

using Counts = std::map<std::string, std::size_t>;

TEST(PlanInstruments, AreInstrumentsOfTheModel) {
  std::set<std::string> names;
  for (const PlanInstrument* each : plan_instruments()) {
    EXPECT_TRUE(names.insert(each->name()).second) << each->name();
    EXPECT_NE(find_instrument(each->instrument()), nullptr) << each->name();
    EXPECT_EQ(find_plan_instrument(each->name()), each);
    EXPECT_GT(each->usual_reading_time(), 0.0);
    for (const std::string& option : each->own_options()) EXPECT_TRUE(option.starts_with("--")) << option;
    const InstrumentWords words = each->words();
    for (const std::string& word : {words.place, words.places, words.heading, words.region, words.checked,
                                    words.unreached, words.unreached_remedy})
      EXPECT_FALSE(word.empty()) << each->name();
  }
  PlanSettings settings = one_bar();
  settings.instrument = "straightness";
  EXPECT_THROW(plan_instrument_of(settings), InputError);
}

/// Every instrument says of a setup what it has written into it.
TEST(PlanInstruments, FindTheirPlacesAgain) {
  for (const PlanInstrument* each : plan_instruments()) {
    PlanSettings settings = one_bar();
    if (each->turns_rotary_axes()) settings.machine = testing_support::five_axis_machine("w C' A' b X Y Z t");
    settings.instrument = each->name();
    const PlanLayout layout = textbook_layout(settings, LineOfSight(settings));
    const Campaign campaign = campaign_of(layout, settings);
    ASSERT_EQ(campaign.setups.size(), layout.runs.size());
    for (std::size_t run = 0; run < layout.runs.size(); ++run) {
      const volcal::Setup& setup = campaign.setups[run];
      const auto place = each->place_of(setup, settings.machine);
      ASSERT_TRUE(place) << setup.name;
      const auto known = std::ranges::find(layout.station_names, place->name);
      ASSERT_NE(known, layout.station_names.end()) << place->name;
      EXPECT_EQ(layout.stations_w[static_cast<std::size_t>(known - layout.station_names.begin())],
                place->place_w);
      EXPECT_EQ(place->part, layout.runs[run].part);
    }
  }
}

TEST(SweptVolume, FindsWhereTheAxesStand) {
  const PlanSettings settings = one_bar();
  const SweptVolume swept(settings);
  const auto position = swept.position_at({0.3, 0.2, 0.1}, 0);
  ASSERT_TRUE(position);
  EXPECT_NEAR((*position)[index_of(AxisName::X)], 0.3, 1e-12);
  EXPECT_NEAR((*position)[index_of(AxisName::Y)], 0.2, 1e-12);
  EXPECT_NEAR((*position)[index_of(AxisName::Z)], 0.25, 1e-12);  // the tool is 150 mm below
  EXPECT_FALSE(swept.position_at({0.3, 0.2, 0.351}, 0));
  EXPECT_FALSE(swept.position_at({-0.001, 0.2, 0.1}, 0));
}

/// A table that moves, and a tool to the side: the point comes out where it was wanted.
TEST(SweptVolume, FindsTheAxesOfEveryStructure) {
  PlanSettings settings = one_bar();
  settings.machine = sim::reference_machines()[1];
  const SweptVolume swept(settings);
  for (std::size_t tool = 0; tool < settings.machine.tools.size(); ++tool) {
    const Eigen::Vector3d wanted_w(0.05, -0.02, -0.4);
    const auto position = swept.position_at(wanted_w, tool);
    ASSERT_TRUE(position) << tool;
    EXPECT_LT((swept.point_w(*position, tool) - wanted_w).norm(), 1e-12) << tool;
  }
}

TEST(BallBarPlan, WholeCirclesWhereTheTravelAllows) {
  EXPECT_EQ(paths_about(one_bar(), {0.5, 0.3, 0.1}), (Counts{{"XY", 36}, {"YZ", 36}, {"ZX", 36}}));
  EXPECT_EQ(paths_about(one_bar(), {0.1, 0.1, -0.05}), (Counts{{"XY", 36}, {"YZ", 36}, {"ZX", 36}}));
}

/// A position every ten degrees. 50 mm from the end of X the bar points at most 120 degrees off +x; 50 mm
/// beyond it, at most 60; 80 mm beyond it, at most 36, less than the quarter of a turn that a path needs.
TEST(BallBarPlan, ArcsWhereTheTravelEnds) {
  EXPECT_EQ(paths_about(one_bar(), {0.05, 0.3, 0.1}), (Counts{{"XY", 25}, {"YZ", 36}, {"ZX", 25}}));
  EXPECT_EQ(paths_about(one_bar(), {-0.05, 0.3, 0.1}), (Counts{{"XY", 13}, {"ZX", 13}}));
  EXPECT_EQ(paths_about(one_bar(), {-0.08, 0.3, 0.1}), Counts{});
  EXPECT_EQ(paths_about(one_bar(), {0.0, 0.0, -0.15}), (Counts{{"XY", 10}, {"YZ", 10}, {"ZX", 10}}));
  const PlanSettings settings = one_bar();
  const std::vector<PlanRun> runs = LineOfSight(settings).candidate_runs({0.05, 0.3, 0.1}, 0, 0, {});
  const AxisPosition& first = runs.front().positions.front().position;  // at -120 degrees
  EXPECT_NEAR(first[index_of(AxisName::X)], 0.0, 1e-12);
  EXPECT_NEAR(first[index_of(AxisName::Y)], 0.3 - 0.1 * std::sqrt(0.75), 1e-6);
}

/// With the tool below the centre ball the spindle, 150 mm above the tool, comes within 100 mm of the bar
/// when 150^2 + 100^2 - 2 150 100 sin < 100^2, sin > 0.75: from 48.6 to 131.4 degrees below, nine positions.
TEST(BallBarPlan, IsEndedByTheSpindle) {
  PlanSettings settings = one_bar();
  settings.surroundings.spindle_radius = 0.1;
  EXPECT_EQ(paths_about(settings, {0.5, 0.3, 0.1}), (Counts{{"XY", 36}, {"YZ", 27}, {"ZX", 27}}));
}

TEST(BallBarPlan, ReachesWhatIsABarAway) {
  const PlanSettings settings = one_bar();
  const LineOfSight sight(settings);
  const AxisPosition origin{};  // functional point at (0, 0, -150) mm
  EXPECT_TRUE(sight.sees({0.1, 0.0, -0.15}, origin, 0));
  EXPECT_TRUE(sight.sees({0.0, 0.1009, -0.15}, origin, 0));
  EXPECT_FALSE(sight.sees({0.0, 0.102, -0.15}, origin, 0));  // a millimetre of stroke
  EXPECT_TRUE(sight.can_stand({0.5, 0.3, 0.1}));
  EXPECT_FALSE(sight.can_stand({0.5, 0.3, 0.36}));  // above every functional point
}

TEST(BallBarPlan, FollowsItsCentreBall) {
  const PlanSettings settings = one_bar();
  const LineOfSight sight(settings);
  const PlanRun circle = sight.candidate_runs({0.5, 0.3, 0.1}, 0, 0, {}).back();
  ASSERT_EQ(circle.part, "ZX");
  EXPECT_EQ(sight.moved({0.05, 0.3, 0.1}, circle).positions.size(), 25U);
  EXPECT_TRUE(sight.moved({-0.08, 0.3, 0.1}, circle).positions.empty());
}

/// Counter-clockwise from +x the machine moves to -x and +y, clockwise it comes back there the other way; at
/// the extreme, 180 degrees, it comes towards -x both ways. Z rests, always approached alike.
TEST(BallBarPlan, RunsBothWaysRound) {
  const PlanSettings settings = one_bar();
  const PlanRun circle = LineOfSight(settings).candidate_runs({0.5, 0.3, 0.1}, 0, 0, {}).front();
  const std::vector<PlanReading> readings = readings_of(circle);
  ASSERT_EQ(readings.size(), 72U);
  const auto direction = [&](std::size_t i) {
    const auto& all = readings[i].direction;
    return std::array<int, 2>{all[index_of(AxisName::X)], all[index_of(AxisName::Y)]};
  };
  EXPECT_EQ(direction(0), (std::array<int, 2>{-1, 1}));
  EXPECT_EQ(direction(71), (std::array<int, 2>{1, -1}));
  EXPECT_EQ(direction(18), (std::array<int, 2>{-1, -1}));
  EXPECT_EQ(direction(53), (std::array<int, 2>{-1, 1}));  // the same position on the way back
  EXPECT_EQ(readings[18].position, readings[53].position);
  for (std::size_t i = 0; i < readings.size(); ++i) {
    EXPECT_EQ(readings[i].direction[index_of(AxisName::Z)], 1);
    EXPECT_EQ(readings[i].run, i < 36 ? 0 : 1);
    EXPECT_EQ(readings[i].line, readings[i].run);
  }
}

/// Two places a quarter and three quarters along X; the sixth circle of 72 readings does not fit into 431.
TEST(BallBarPlan, TextbookGoesThroughTheMiddle) {
  PlanSettings settings = one_bar();
  settings.budget.readings = 432;
  const PlanLayout all = textbook_layout(settings, LineOfSight(settings));
  EXPECT_TRUE(all.stations_w[0].isApprox(Eigen::Vector3d(0.25, 0.3, 0.1)));
  EXPECT_TRUE(all.stations_w[1].isApprox(Eigen::Vector3d(0.75, 0.3, 0.1)));
  EXPECT_EQ(all.readings(), 432U);
  settings.budget.readings = 431;
  EXPECT_EQ(textbook_layout(settings, LineOfSight(settings)).readings(), 360U);
}

TEST(BallBarPlan, IsACampaignOfItsInstrument) {
  const PlanSettings settings = one_bar();
  const Campaign campaign = campaign_of(textbook_layout(settings, LineOfSight(settings)), settings);
  ASSERT_EQ(campaign.setups.size(), 6U);
  EXPECT_EQ(campaign.setups[1].name, "P1_short_YZ");
  for (const volcal::Setup& setup : campaign.setups) {
    EXPECT_EQ(setup.instrument, "ball-bar");
    EXPECT_EQ(*setup.options.number("length_sigma"), 0.5e-6);
    for (const double length : setup.readings.value[0]) EXPECT_NEAR(length, 0.1, 2e-6);  // whole micrometres
  }
}

/// Of six circles those that fit, whole, one at least about each place; with readings for one alone none can.
TEST(BallBarPlan, TakesWholeCirclesWithinTheBudget) {
  PlanSettings settings = one_bar();
  const PlanLayout all = textbook_layout(settings, LineOfSight(settings));
  const PlanProblem problem(settings);
  for (const int readings : {432, 300, 144}) {
    settings.budget.readings = readings;
    const PlanLayout chosen = choose_paths(settings, problem, all, 2).layout;
    EXPECT_EQ(chosen.runs.size(), static_cast<std::size_t>(readings) / 72);
    std::set<std::size_t> places;
    for (const PlanRun& run : chosen.runs) {
      EXPECT_EQ(run.positions.size(), 36U);
      places.insert(run.station);
    }
    EXPECT_THAT(places, ElementsAre(0U, 1U));
  }
  settings.budget.readings = 100;
  EXPECT_THROW(choose_paths(settings, problem, all, 2), InputError);
  settings.budget.readings.reset();
  settings.budget.time = 2 * 1200.0 + 4 * 320.0;  // two places, four circles of 300 s and less than 20
  EXPECT_EQ(choose_paths(settings, problem, all, 2).layout.runs.size(), 4U);
}

/// The best two of six circles, against every pair.
TEST(BallBarPlan, FindsTheBestPair) {
  PlanSettings settings = one_bar();
  settings.budget.readings = 144;
  settings.target = PlanTarget::Symbol;
  settings.symbol = MachineError::parse("EC0Y");
  const PlanProblem problem(settings);
  settings.budget.readings = 432;
  const PlanLayout all = textbook_layout(settings, LineOfSight(settings));
  settings.budget.readings = 144;
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < all.runs.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (all.runs[i].station == all.runs[k].station) continue;
      PlanLayout pair = all;
      pair.runs = {all.runs[k], all.runs[i]};
      best = std::min(best, problem.value(pair));
    }
  }
  EXPECT_NEAR(problem.value(choose_paths(settings, problem, all, 2).layout) / best, 1.0, 1e-3);
}

TEST(BallBarPlan, RefusesWhatCannotBeMeasured) {
  PlanSettings settings = one_bar();
  settings.bar.length = 0.0;
  EXPECT_THROW(check_plan_settings(settings), InputError);
  settings.bar.length = 1.5;  // longer than every travel
  EXPECT_THROW(textbook_layout(settings, LineOfSight(settings)), InputError);
  settings = one_bar();
  settings.budget.readings = 40;
  EXPECT_THROW(textbook_layout(settings, LineOfSight(settings)), InputError);
}

}  // namespace
}  // namespace volcal
