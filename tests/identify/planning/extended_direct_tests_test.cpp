/// Plans that add to displacements, straightness and angles: what a setup brings along does not depend on how
/// few of its rows the search looks at.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/planning/campaign_plan.h"
#include "volcal/identify/planning/plan_problem.h"

namespace volcal {
namespace {

/// Some setups of the example whose readings are displacements, straightness, angles and lengths.
Campaign direct_tests(const std::vector<std::string>& setups) {
  Campaign campaign =
      read_campaign(std::string(VOLCAL_SOURCE_DIR) + "/datasets/examples/mixed-1/campaign.toml");
  std::erase_if(campaign.setups,
                [&](const Setup& setup) { return std::ranges::find(setups, setup.name) == setups.end(); });
  return campaign;
}

PlanSettings plan_after(const Campaign& existing) {
  PlanSettings settings;
  settings.machine = existing.machine;
  settings.model.default_function.basis = "legendre";
  settings.model.default_function.degree = 2;
  settings.budget.stations = 1;
  settings.budget.readings = 60;
  settings.threads = 1;
  settings.existing = &existing;
  return settings;
}

double textbook_value(const PlanSettings& settings) {
  return PlanProblem(settings).value(textbook_layout(settings, LineOfSight(settings)));
}

Setup& setup_named(const std::string& name, Campaign& campaign) {
  return *std::ranges::find(campaign.setups, name, &Setup::name);
}

TEST(ExtendedDirectTests, ADirectionIsTheSameStatedOrFollowingFromThePositions) {
  Campaign campaign = direct_tests({"linX1", "diag1", "strXY1", "angXA"});
  setup_named("linX1", campaign).options.set("direction", Eigen::Vector3d(1.0, 0.0, 0.0));
  const double stated = textbook_value(plan_after(campaign));
  volcal::Setup& line = setup_named("linX1", campaign);
  Options without;
  for (const auto& [key, value] : line.options.all()) {
    if (key.first != "direction") without.set(key.first, value);
  }
  line.options = without;
  const double following = textbook_value(plan_after(campaign));
  EXPECT_TRUE(std::isfinite(stated));
  EXPECT_NEAR(following / stated, 1.0, 1e-9);
}

/// There and back along one line: by what their offsets differ says nothing of the machine.
TEST(ExtendedDirectTests, EveryLineKeepsItsOffset) {
  Campaign campaign = direct_tests({"linX1", "linY1"});
  for (volcal::Setup& setup : campaign.setups) setup.options.set("direction", Eigen::Vector3d(1.0, 0.0, 0.0));
  setup_named("linY1", campaign).options.set("direction", Eigen::Vector3d(0.0, 1.0, 0.0));
  const auto value_with = [&](const std::string& offset_per) {
    for (volcal::Setup& setup : campaign.setups) setup.options.set("offset_per", offset_per);
    return textbook_value(plan_after(campaign));
  };
  const double per_setup = value_with("setup"), per_line = value_with("line");
  EXPECT_TRUE(std::isfinite(per_line));
  EXPECT_NEAR(per_line / per_setup, 1.0, 0.01);
}

TEST(ExtendedDirectTests, ASetupIsAdded) {
  Campaign campaign = direct_tests({"linX1", "diag1", "strXY1", "angXA", "T1"});
  setup_named("linX1", campaign).options.set("offset_per", std::string("line"));
  const CampaignPlan plan = extend_campaign(plan_after(campaign));
  ASSERT_EQ(plan.plan.campaign.setups.size(), campaign.setups.size() + 1);
  EXPECT_LT(plan.plan.volumetric.rms, plan.given->volumetric.rms);
}

}  // namespace
}  // namespace volcal
