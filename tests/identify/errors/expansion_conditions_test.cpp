// Expansions by effects: 20 degC of their temperature is where errors are stated, whatever the kind of the
// effect.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/machines.h"
#include "volcal/identify/errors/conditions.h"
#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/identify/solve/summaries.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

constexpr double kPerKelvin = 10e-6;

EffectSpec with_amplitude(EffectSpec spec) {
  spec.options.set("amplitude", kPerKelvin);
  return spec;
}

EffectSpec expansion_of(const std::string& axis) {
  return with_amplitude(
      effect_spec("scale-expansion", {{"axis", axis}, {"temperature", std::string("bed")}}));
}

/// The same as one effect and as three.
std::vector<std::vector<EffectSpec>> same_expansions() {
  return {{with_amplitude(effect_spec(
              "common-expansion", {{"axes", std::string("X Y Z")}, {"temperature", std::string("bed")}}))},
          {expansion_of("X"), expansion_of("Y"), expansion_of("Z")}};
}

FitResult stated_with(const std::vector<EffectSpec>& effects) {
  ModelSpec model;
  model.default_function.basis = "zero";
  model.effects = effects;
  model.conditions.temperature_degC["bed"] = {28.0, 29.1, 30.0};
  model.conditions.temperature_degC["air"] = {22.0, 23.1, 24.0};
  return stated_result(testing_support::machine_of("w X' b Y Z t"), model);
}

TEST(ConditionsOfExpansions, AreTwentyDegreesOfTheirChannel) {
  AxisPosition end{};
  end[index_of(AxisName::X)] = 0.5;
  for (const std::vector<EffectSpec>& effects : same_expansions()) {
    const FitResult result = stated_with(effects);
    Conditions conditions = default_conditions(result);
    EXPECT_EQ(conditions.temperature_degC.at("bed"), 20.0) << effects.front().kind;
    EXPECT_EQ(conditions.temperature_degC.at("air"), 23.1) << effects.front().kind;
    EXPECT_EQ(stated_reference_temperature(result, conditions), 20.0);
    const Tool spindle = result.machine.functional_tools().front();
    EXPECT_NEAR(ErrorField(result, spindle, conditions).at(end)[0], 0.0, 1e-15);
    conditions.temperature_degC["bed"] = 29.0;
    EXPECT_NEAR(ErrorField(result, spindle, conditions).at(end)[0], kPerKelvin * 9.0 * 0.5, 1e-15);
    EXPECT_EQ(stated_reference_temperature(result, conditions), 29.0);
    for (const StatedCondition& each : list_conditions(result, default_conditions(result))) {
      EXPECT_EQ(each.origin == "reference temperature", each.name() == "T_bed_degC") << each.name();
    }
  }
}

TEST(ConditionsOfExpansions, MakeNoMeanOfTheCampaignTheReference) {
  Campaign campaign;
  campaign.machine = testing_support::machine_of("w X' b Y Z t");
  campaign.setups.resize(1);
  campaign.setups[0].readings.temperature = {{"bed", {29.0, 29.2}}, {"air", {23.0, 23.2}}};
  for (const std::vector<EffectSpec>& effects : same_expansions()) {
    FitResult result = stated_with(effects);
    summarise_temperature(campaign, result);
    EXPECT_FALSE(result.temperature_is_campaign_mean) << effects.front().kind;
    EXPECT_EQ(result.reference_temperature_degC, 20.0) << effects.front().kind;
  }
}

}  // namespace
}  // namespace volcal
