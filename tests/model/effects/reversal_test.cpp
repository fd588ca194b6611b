#include <gtest/gtest.h>

#include <string>

#include "tests/support/machines.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

using testing_support::machine_of;

EffectSpec reversal_of(const std::string& symbol) {
  EffectSpec spec;
  spec.kind = "reversal";
  spec.source_line = 5;
  spec.options.set("symbol", symbol);
  return spec;
}

Campaign campaign_with_directions(std::vector<std::int8_t> directions) {
  Campaign campaign;
  campaign.machine = machine_of("w X' b Y Z t");
  campaign.setups.resize(1);
  Readings& readings = campaign.setups[0].readings;
  readings.direction[index_of(AxisName::Y)] = std::move(directions);
  readings.source_line = {2, 3, 4};
  return campaign;
}

std::unique_ptr<Effect> made_reversal(const EffectSpec& spec) {
  return find_effect("reversal")->make(spec, "model.toml");
}

/// Half the reversal each way; nothing where the direction is unknown or the column is missing.
TEST(Reversal, FollowsTheDirectionOfItsOwnAxis) {
  const Campaign campaign = campaign_with_directions({+1, -1, 0});
  const SetupView view{campaign, campaign.setups[0], {}, {}};
  EXPECT_EQ(made_reversal(reversal_of("EXY"))->drivers(view, {}), Eigen::Vector3d(0.5, -0.5, 0.0));
  EXPECT_EQ(made_reversal(reversal_of("EXZ"))->drivers(view, {}), Eigen::Vector3d::Zero());
  EXPECT_EQ(made_reversal(reversal_of("EXY"))->unrecorded(view), 1U);
  EXPECT_EQ(made_reversal(reversal_of("EXZ"))->unrecorded(view), 3U);
}

TEST(Reversal, TargetsItsSymbolInItsUnit) {
  const auto length = made_reversal(reversal_of("EYY"));
  EXPECT_EQ(length->amplitudes()[0].label, "reversal EYY");
  EXPECT_EQ(length->amplitudes()[0].unit(), "um");
  EXPECT_EQ(length->amplitudes()[0].target.symbol, (ErrorSymbol{Component::Y, AxisName::Y}));
  EXPECT_EQ(length->name(), EffectName::of_parts("reversal", "EYY", "dir_y", "step"));
  EXPECT_EQ(made_reversal(reversal_of("ECX"))->amplitudes()[0].unit(), "urad");
}

TEST(Reversal, TakesTheValueOfAnIdentifiedModel) {
  EffectSpec spec = reversal_of("EYY");
  spec.options.set("amplitude", 3.5e-6);
  EXPECT_EQ(made_reversal(spec)->amplitudes()[0].guess, 3.5e-6);
}

TEST(Reversal, RefusesWhatIsNoErrorMotionOfTheMachine) {
  const Campaign campaign = campaign_with_directions({+1, -1, 0});
  for (const char* wrong : {"EXW", "XX", "EC0Y", "EXC", ""}) {
    try {
      made_reversal(reversal_of(wrong))->check(campaign, {"model.toml", 5});
      ADD_FAILURE() << wrong << " is accepted";
    } catch (const InputError& error) {
      EXPECT_EQ(error.place().line, 5);
      EXPECT_FALSE(error.remedy().empty());
    }
  }
}

}  // namespace
}  // namespace volcal
