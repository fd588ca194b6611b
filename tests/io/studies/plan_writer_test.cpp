#include "volcal/identify/io/plan_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/five_axis.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/planning/line_of_sight.h"
#include "volcal/identify/planning/plan_search.h"
#include "volcal/identify/planning/registry.h"
#include "volcal/identify/report/text/plan_text.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/studies/files/study_reader.h"

namespace volcal {
namespace {

using testing::ScratchFolder;

/// The readings of the campaign, setup by setup, at the same positions.
void expect_measured(const Campaign& planned, const Campaign& measured) {
  ASSERT_EQ(measured.setups.size(), planned.setups.size());
  for (std::size_t k = 0; k < planned.setups.size(); ++k) {
    const Readings &wanted = planned.setups[k].readings, &taken = measured.setups[k].readings;
    EXPECT_EQ(measured.setups[k].instrument, planned.setups[k].instrument);
    EXPECT_EQ(measured.setups[k].tool, planned.setups[k].tool);
    ASSERT_EQ(taken.size(), wanted.size());
    for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
      ASSERT_EQ(taken.position[axis].size(), wanted.position[axis].size());
      for (std::size_t row = 0; row < wanted.position[axis].size(); ++row)
        ASSERT_NEAR(taken.position[axis][row], wanted.position[axis][row], 1e-9);
    }
  }
}

TEST(StudyOfAPlan, MeasuresThePlanOfEveryInstrument) {
  PlanSettings settings;
  settings.machine = sim::reference_machines().front();
  settings.bar = {0.1, 0.5e-6};
  settings.budget.stations = 2;
  settings.budget.readings = 600;
  for (const PlanInstrument* each : plan_instruments()) {
    SCOPED_TRACE(each->name());
    settings.instrument = each->name();
    if (each->turns_rotary_axes()) settings.machine = testing_support::five_axis_machine("w C' A' b X Y Z t");
    CampaignPlan plan;
    plan.settings = settings;
    plan.plan.campaign = campaign_of(textbook_layout(settings, LineOfSight(settings)), settings);
    ASSERT_GT(plan.plan.campaign.reading_count(), 0U);
    const ScratchFolder scratch;
    const std::string target = (scratch.path() / "plan").string();
    AtomicFolder folder(target);
    write_plan_campaign(plan, folder);
    folder.commit();
    expect_measured(plan.plan.campaign, sim::simulate(read_study(target + "/study.toml")).campaign);
  }
}

/// 45 mm less 7e-14 mm is what a search leaves of 45 mm.
TEST(StudyOfAPlan, StatesPlacesWithoutTheRoundingOfTheSearch) {
  PlanSettings settings;
  settings.machine = sim::reference_machines().front();
  settings.budget.stations = 1;
  settings.budget.readings = 60;
  CampaignPlan plan;
  plan.settings = settings;
  plan.searched.layout = textbook_layout(settings, LineOfSight(settings));
  plan.searched.layout.stations_w = {Eigen::Vector3d(0.04499999999999993, 0.532, -0.529)};
  plan.plan.campaign = campaign_of(plan.searched.layout, settings);
  EXPECT_THAT(plan_study_toml(plan), ::testing::HasSubstr("position_mm = [45, 532, -529]\n"));
  EXPECT_THAT(plan_json(plan), ::testing::ContainsRegex("45(\\.0)?,\\s+532(\\.0)?,\\s+-529(\\.0)?\\s"));
}

TEST(PlanText, SaysHowManyValuesAReadingIs) {
  PlanSettings settings;
  settings.machine = testing_support::five_axis_machine("w C' A' b X Y Z t");
  const auto values = [&](const char* instrument) {
    settings.instrument = instrument;
    return values_of_a_reading(settings);
  };
  EXPECT_EQ(values("laser-tracer"), 1U);
  EXPECT_EQ(values("laser-tracker"), 3U) << "length, azimuth, elevation";
  EXPECT_EQ(values("r-test"), 3U) << "x, y, z of the sphere";
}

}  // namespace
}  // namespace volcal
