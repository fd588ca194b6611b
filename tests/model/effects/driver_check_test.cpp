#include "volcal/model/effects/driver_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kY = 1;

ModelSpec with(const EffectSpec& effect) {
  ModelSpec model;
  model.file = "model.toml";
  model.effects = {effect};
  model.effects.front().source_line = 7;
  return model;
}

/// Y stands still and was approached from one side, the air was always at 21.5 degC.
Campaign still() {
  Campaign campaign = testing_support::effect_campaign();
  for (auto& setup : campaign.setups) {
    std::ranges::fill(setup.readings.position[kY], 0.1);
    std::ranges::fill(setup.readings.direction[kY], std::int8_t{1});
    if (setup.readings.temperature.contains("air"))
      std::ranges::fill(setup.readings.temperature["air"], 21.5);
  }
  return campaign;
}

void expect_refused(const EffectSpec& effect, const std::string& column) {
  EXPECT_NO_THROW(check_drivers_vary(testing_support::effect_campaign(), with(effect)));
  try {
    check_drivers_vary(still(), with(effect));
    ADD_FAILURE() << effect.kind << " by " << column << " is accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().file, "model.toml");
    EXPECT_EQ(error.place().line, 7);
    EXPECT_THAT(error.problem(), HasSubstr(column + ": the same in all readings"));
    EXPECT_FALSE(error.remedy().empty());
  }
}

TEST(DriverCheck, ADriverThatNeverChangesIsRefused) {
  expect_refused(effect_spec("reversal", {{"symbol", "EYY"}}), "dir_y");
  expect_refused(effect_spec("axis-coupling", {{"symbol", "EBX"}, {"axis", "Y"}}), "y_mm");
  expect_refused(effect_spec("thermal-drift", {{"symbol", "EAZ"}, {"temperature", "air"}}), "T_air_degC");
  expect_refused(effect_spec("custom", {{"target", "EXX"}, {"expression", "dir_y * T_air"}}),
                 "dir_y and T_air_degC");
}

/// One variable that changes is enough for an expression; one tool, or one station, is no recorded variable.
TEST(DriverCheck, WhatStillChangesIsAccepted) {
  for (const EffectSpec& effect :
       {effect_spec("custom", {{"target", "EXX"}, {"expression", "x * T_air"}}),
        effect_spec("reversal", {{"symbol", "EXX"}}),
        effect_spec("thermal-drift", {{"symbol", "EAZ"}, {"temperature", "spindle"}})}) {
    EXPECT_NO_THROW(check_drivers_vary(still(), with(effect))) << effect.kind;
  }
}

/// As words "T_front bearing" are no channel, as a variable it is.
TEST(DriverCheck, AChannelMayHaveABlankInItsName) {
  Campaign campaign = testing_support::effect_campaign();
  for (auto& setup : campaign.setups)
    setup.readings.temperature["front bearing"] = std::vector<double>(setup.readings.size(), 21.5);
  const EffectSpec effect =
      effect_spec("thermal-drift", {{"symbol", "EAZ"}, {"temperature", "front bearing"}});
  try {
    check_drivers_vary(campaign, with(effect));
    ADD_FAILURE() << "a channel that never changes is accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.problem(), HasSubstr("T_front bearing_degC: the same in all readings"));
  }
}

TEST(DriverCheck, DirectionsThatWereNotRecordedAreTheFitsToReport) {
  Campaign campaign = testing_support::effect_campaign();
  for (auto& setup : campaign.setups) setup.readings.direction[kY].clear();
  EXPECT_NO_THROW(check_drivers_vary(campaign, with(effect_spec("reversal", {{"symbol", "EYY"}}))));
  for (auto& setup : campaign.setups) setup.readings.direction[kY].assign(setup.readings.size(), 0);
  EXPECT_NO_THROW(check_drivers_vary(campaign, with(effect_spec("reversal", {{"symbol", "EYY"}}))));
}

TEST(DriverCheck, EveryExampleActsInACampaignThatHasEverything) {
  const Campaign campaign = testing_support::effect_campaign();
  for (const EffectKind* kind : effect_kinds()) {
    for (const EffectSpec& effect : kind->examples(campaign))
      EXPECT_NO_THROW(check_drivers_vary(campaign, with(effect))) << kind->schema().kind;
  }
}

}  // namespace
}  // namespace volcal
