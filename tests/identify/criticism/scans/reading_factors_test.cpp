// Signs and units of files that somebody took the other way round, found by all other readings.

#include "volcal/identify/criticism/scans/reading_factors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/five_axis.h"
#include "volcal/identify/criticism/screening.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

/// A tracer, lines of straightness and angles.
Campaign measured(std::uint64_t seed) {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.seed = seed;
  sim::Tracking tracking;
  tracking.grid = {4, 3, 3};
  study.measurements.push_back({"", tracking});
  study.measurements.push_back({"straightness", sim::StraightnessLines()});
  study.measurements.push_back({"angle", sim::AngleLines()});
  return sim::simulate(study).campaign;
}

void multiply(Setup& setup, double factor) {
  for (auto& channel : setup.readings.value) {
    for (double& value : channel) value *= factor;
  }
}

std::optional<Finding> misread(const Campaign& campaign) {
  return screen(campaign, fit(campaign, ModelSpec{}), 1).misread;
}

void expect_named(const std::optional<Finding>& found, const std::vector<std::string>& setups,
                  double factor) {
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->code, FindingCode::ReadingsMisread);
  EXPECT_EQ(found->texts("setups"), setups);
  EXPECT_EQ(found->number("factor").si, factor);
}

TEST(ReadingFactors, SayNothingOfRightReadings) {
  for (const std::uint64_t seed : {1U, 2U}) EXPECT_FALSE(misread(measured(seed))) << seed;
}

TEST(ReadingFactors, NameTheSetupWhoseSignIsReversed) {
  Campaign campaign = measured(4);
  for (const char* instrument : {"straightness", "angle"}) {
    Campaign other = campaign;
    const auto setup = std::ranges::find(other.setups, std::string(instrument), &Setup::instrument);
    multiply(*setup, -1.0);
    expect_named(misread(other), {setup->name}, -1.0);
  }
}

TEST(ReadingFactors, NameTheSetupOfAThousandthOfTheUnit) {
  Campaign campaign = measured(5);
  const auto setup = std::ranges::find(campaign.setups, std::string("straightness"), &Setup::instrument);
  multiply(*setup, 1e-3);
  expect_named(misread(campaign), {setup->name}, 1e3);
}

/// Sphere against nest or nest against sphere.
TEST(ReadingFactors, NameAnRTestThatIsReadTheOtherWayRound) {
  sim::Study study;
  study.machine = testing_support::five_axis_machine("w C' A' b X Y Z t");
  study.seed = 6;
  sim::RTest r_test;
  r_test.poses.spheres = {{"S1", {0.1, 0.02, 0.05}}, {"S2", {-0.08, 0.06, 0.09}}};
  r_test.poses.grid.points = {{AxisName::A, 5}, {AxisName::C, 8}};
  study.measurements.emplace_back().settings = r_test;
  sim::Tracking tracking;
  tracking.grid = {4, 4, 3};
  tracking.rotary = sim::RotaryMotion::Grid;
  tracking.rotary_grid.points = {{AxisName::A, 5}, {AxisName::C, 8}};
  study.measurements.push_back({"", tracking});
  Campaign campaign = sim::simulate(study).campaign;
  EXPECT_FALSE(misread(campaign));
  std::vector<std::string> names;
  for (auto& setup : campaign.setups) {
    if (setup.instrument != "r-test") continue;
    multiply(setup, -1.0);
    names.push_back(setup.name);
  }
  expect_named(misread(campaign), names, -1.0);
}

}  // namespace
}  // namespace volcal
