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

/// Half the reversal each way; nothing where the direction is unknown or the column is missing.
TEST(Reversal, FollowsTheDirectionOfItsOwnAxis) {
  const Campaign campaign = campaign_with_directions({+1, -1, 0});
  const EffectKind& kind = *find_effect("reversal");
  const auto of_y = kind.bind(reversal_of("EXY"), "model.toml", campaign.machine);
  const auto of_z = kind.bind(reversal_of("EXZ"), "model.toml", campaign.machine);
  double driver = 7.0;
  of_y->drivers(campaign.setups[0], 0, &driver);
  EXPECT_EQ(driver, 0.5);
  of_y->drivers(campaign.setups[0], 1, &driver);
  EXPECT_EQ(driver, -0.5);
  of_y->drivers(campaign.setups[0], 2, &driver);
  EXPECT_EQ(driver, 0.0);
  of_z->drivers(campaign.setups[0], 0, &driver);
  EXPECT_EQ(driver, 0.0);
}

TEST(Reversal, TargetsItsSymbolInItsUnit) {
  const Machine machine = machine_of("w X' b Y Z t");
  const EffectKind& kind = *find_effect("reversal");
  const auto length = kind.bind(reversal_of("EYY"), "model.toml", machine);
  EXPECT_EQ(length->amplitudes()[0].label, "reversal EYY");
  EXPECT_EQ(length->amplitudes()[0].unit, "um");
  EXPECT_EQ(length->amplitudes()[0].target, (ErrorSymbol{Component::Y, AxisName::Y}));
  EXPECT_EQ(kind.bind(reversal_of("ECX"), "model.toml", machine)->amplitudes()[0].unit, "urad");
}

TEST(Reversal, TakesTheValueOfAnIdentifiedModel) {
  EffectSpec spec = reversal_of("EYY");
  spec.options.set("amplitude", 3.5e-6);
  const auto bound = find_effect("reversal")->bind(spec, "model.toml", machine_of("w X' b Y Z t"));
  EXPECT_EQ(bound->amplitudes()[0].guess, 3.5e-6);
}

TEST(Reversal, IsVisibleWhenBothDirectionsOccur) {
  const EffectKind& kind = *find_effect("reversal");
  EXPECT_TRUE(kind.visible_in(reversal_of("EYY"), campaign_with_directions({+1, -1, 0})));
  EXPECT_FALSE(kind.visible_in(reversal_of("EYY"), campaign_with_directions({+1, +1, 0})));
  EXPECT_FALSE(kind.visible_in(reversal_of("EYY"), campaign_with_directions({})));
  EXPECT_FALSE(kind.visible_in(reversal_of("EXX"), campaign_with_directions({+1, -1, 0})));
}

TEST(Reversal, RefusesWhatIsNoErrorMotionOfTheMachine) {
  const Machine machine = machine_of("w X' b Y Z t");
  const EffectKind& kind = *find_effect("reversal");
  for (const char* wrong : {"EXW", "XX", "EC0Y", "EXC", ""}) {
    try {
      kind.bind(reversal_of(wrong), "model.toml", machine);
      ADD_FAILURE() << wrong << " is accepted";
    } catch (const InputError& error) {
      EXPECT_EQ(error.place().line, 5);
      EXPECT_NE(error.problem().find(wrong), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace volcal
