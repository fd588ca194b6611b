// Effects that a diagnosis cannot look for.

#include "volcal/identify/criticism/catalogue/not_looked_for.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "volcal/model/description/finding_codes.h"
#include "volcal/model/effects/registry.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/study.h"

namespace volcal {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

Campaign tracked_campaign() {
  sim::Study study;
  study.machine = sim::reference_machines()[0];
  study.seed = 5;
  sim::Tracking tracking;
  tracking.grid = {3, 3, 3};
  study.measurements.emplace_back().settings = tracking;
  study.validation.points = 10;
  return sim::simulate(study).campaign;
}

std::vector<Family> reversals(const Campaign& campaign) {
  std::vector<Family> families;
  const EffectKind& kind = *find_effect("reversal");
  for (EffectSpec& spec : kind.candidates(campaign)) {
    std::unique_ptr<Effect> effect = kind.make(spec, {});
    families.push_back({std::move(spec), std::move(effect), std::nullopt, {Eigen::VectorXd()}});
  }
  return families;
}

TEST(NotLookedFor, NothingWhereEverythingIsRecorded) {
  const Campaign campaign = tracked_campaign();
  EXPECT_THAT(not_looked_for(campaign, reversals(campaign)), IsEmpty());
}

TEST(NotLookedFor, NamesTheKindsThatNeedDirectionsOrTimes) {
  Campaign campaign = tracked_campaign();
  for (volcal::Setup& setup : campaign.setups) {
    setup.readings.time.clear();
    setup.readings.direction[0].clear();
  }
  const std::vector<Finding> findings = not_looked_for(campaign, reversals(campaign));
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].code, FindingCode::DirectionsUnrecorded);
  EXPECT_THAT(findings[0].texts("columns"), ElementsAre("dir_x"));
  EXPECT_THAT(findings[0].texts("kinds"), Contains("reversal"));
  EXPECT_EQ(findings[1].code, FindingCode::TimesUnrecorded);
  EXPECT_THAT(findings[1].texts("kinds"), Contains("station-drift"));
}

}  // namespace
}  // namespace volcal
