// Names of effects as types: their texts, and what is read of them.

#include "volcal/model/effects/effect_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

using Kind = Variable::Kind;

constexpr ErrorSymbol kEAY{Component::A, AxisName::Y};

TEST(TargetName, IsWrittenOfWhatItIs) {
  EXPECT_EQ(TargetName(kEAY).name(), "EAY");
  EXPECT_EQ(TargetName(LocationSymbol{Component::C, AxisName::Y}).name(), "EC0Y");
  EXPECT_EQ(TargetName(std::vector{kEAY, ErrorSymbol{Component::X, AxisName::X}}).name(), "EAY EXX");
  EXPECT_EQ(TargetName::of_tool().name(), "tool");
  EXPECT_EQ(TargetName::of_tool("long").name(), "tool long");
  EXPECT_EQ(TargetName::of_tool("long", 0).name(), "tool long x");
  EXPECT_EQ(TargetName::of_tool({}, 2).name(), "tool z");
  EXPECT_EQ(TargetName::of_station().name(), "stations");
  EXPECT_EQ(TargetName::of_station("P1", 1).name(), "station P1 y");
  EXPECT_EQ(TargetName::of_readings().name(), "readings");
  EXPECT_EQ(TargetName::of_readings("S1").name(), "readings of S1");
  EXPECT_EQ(TargetName(kEAY).within("P1").name(), "EAY of P1");
}

TEST(TargetName, IsReadAsWhatItWasWrittenOf) {
  EXPECT_THAT(names_of(TargetName::parse("EAY EXX of P1").errors()), ::testing::ElementsAre("EAY", "EXX"));
  EXPECT_EQ(TargetName::parse("EC0Y").errors().at(0).location(), (LocationSymbol{Component::C, AxisName::Y}));
  EXPECT_EQ(TargetName::parse("tool long x").owner(), (Variable{.kind = Kind::Tool, .subject = "long"}));
  EXPECT_EQ(TargetName::parse("station P1").owner(), (Variable{.kind = Kind::Station, .subject = "P1"}));
  for (const char* all : {"tool", "tool x", "stations", "readings of S1", "machine about y", ""}) {
    EXPECT_FALSE(TargetName::parse(all).owner()) << all;
    EXPECT_THAT(TargetName::parse(all).errors(), ::testing::IsEmpty()) << all;
    EXPECT_EQ(TargetName::parse(all).name(), all);
  }
}

TEST(EffectDriver, HasVariablesAndATextOfItsOwn) {
  const Variable time{Kind::Time}, bearing = temperature_of("front bearing");
  EXPECT_EQ(EffectDriver({time, position_of(AxisName::X)}).name(), "time x");
  EXPECT_EQ(EffectDriver::written({time, bearing}).name(), "t T_front_bearing");
  const auto rate = EffectDriver::called("rate of T_front bearing", {bearing});
  EXPECT_EQ(rate.name(), "rate of T_front bearing");
  EXPECT_TRUE(rate.is(bearing));
  EXPECT_FALSE(rate.has(time));
  EXPECT_FALSE(EffectDriver({time, bearing}).is(time)) << "not alone";
  EXPECT_TRUE(EffectDriver({time, bearing}).has(bearing));
  EXPECT_FALSE(EffectDriver::called("run 2", {}, {{Kind::Run}}).has({Kind::Run}))
      << "it is not a function of it";
}

TEST(EffectName, IsReadFromItsFourParts) {
  const auto name = EffectName::parse("custom:EAY of P1:t dir_y:t > 0 ? 1 : dir_y");
  ASSERT_TRUE(name);
  EXPECT_EQ(name->kind, "custom");
  EXPECT_EQ(name->target.name(), "EAY of P1");
  EXPECT_EQ(name->driver.variables(),
            (std::vector{Variable{Kind::Time}, direction_of_approach(AxisName::Y)}));
  EXPECT_EQ(name->shape, "t > 0 ? 1 : dir_y") << "an expression has colons of its own";
  EXPECT_EQ(full_name(*name), "custom:EAY of P1:t dir_y:t > 0 ? 1 : dir_y");
  for (const char* wrong : {"", "reversal", "reversal:EXX:dir_x", "reversal::dir_x:step", ":EXX:dir_x:step",
                            "reversal:EXX:dir_x:"})
    EXPECT_FALSE(EffectName::parse(wrong)) << wrong;
}

/// What is read of a text is what the effect had declared; a channel with a blank and a tool that is called
/// like a direction are known to the effect alone.
TEST(EffectName, OfEveryRegisteredEffectReadsAsItIs) {
  for (const char* structure : {"w X' b Y Z t", "w C' A' X' b Y Z t"}) {
    const Campaign campaign = testing_support::effect_campaign(structure);
    for (const EffectKind* kind : effect_kinds()) {
      for (const EffectSpec& spec : kind->examples(campaign)) {
        const EffectName own = kind->make(spec, {})->name();
        const auto read = EffectName::parse(full_name(own));
        ASSERT_TRUE(read) << full_name(own);
        EXPECT_EQ(*read, own);
        EXPECT_EQ(read->target.errors(), own.target.errors()) << full_name(own);
        EXPECT_EQ(read->target.owner(), own.target.owner()) << full_name(own);
        for (const Variable& variable : own.driver.variables())
          EXPECT_TRUE(read->driver.has(variable)) << full_name(own) << ": " << variable.name();
      }
    }
  }
}

/// A label is its effect's and its part's; effects of one amplitude have no parts.
TEST(EffectAmplitude, IsOnePartOfWhatItsEffectDescribes) {
  const Campaign campaign = testing_support::effect_campaign("w C' A' X' b Y Z t");
  for (const EffectKind* kind : effect_kinds()) {
    for (const EffectSpec& spec : kind->examples(campaign)) {
      const auto effect = kind->make(spec, {});
      for (const EffectAmplitude& amplitude : effect->amplitudes()) {
        if (effect->amplitudes().size() == 1) {
          EXPECT_EQ(amplitude.part, "") << amplitude.label;
          EXPECT_EQ(common_label(*effect), amplitude.label);
        } else {
          EXPECT_FALSE(amplitude.part.empty()) << amplitude.label;
          EXPECT_EQ(amplitude.label, common_label(*effect) + " " + amplitude.part);
        }
      }
    }
  }
  const auto lead = find_effect("lead-error")->make(effect_spec("lead-error", {{"symbol", "EXX"}}), {});
  EXPECT_EQ(common_label(*lead), "lead error EXX");
  EXPECT_EQ(lead->amplitudes().at(1).part, "sin");
  EXPECT_EQ(lead->shapes().at(0).word(), "period");
  const auto growth = find_effect("spindle-growth")->make(effect_spec("spindle-growth", {}), {});
  EXPECT_EQ(growth->shapes().at(0).word(), "time constant");
}

}  // namespace
}  // namespace volcal
