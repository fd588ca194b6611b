// Campaigns of the study of model criticism on machines with rotary axes: what is planned, and that the name
// that counts as right is the one that the hidden effect has in the catalogue.

#include "volcal/studies/criticism/rotary_campaigns.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

#include "volcal/identify/solve/priors/resolution.h"
#include "volcal/model/observation/measurement_model.h"
#include "volcal/studies/criticism/criticism_names.h"
#include "volcal/studies/criticism/criticism_plan.h"

namespace volcal::studies {
namespace {

constexpr int kReadings = 1500;

std::string symbol_in(const sim::HiddenEffect& effect) { return *effect.options.text("symbol"); }

/// By hand, kind by kind: "EY0C" moves with a temperature as the constant of EYC does.
std::string expected_name(const sim::HiddenEffect& effect) {
  const std::string symbol = symbol_in(effect);
  if (effect.kind == "worm") return "worm-error " + symbol;
  if (effect.kind == "cradle-table") return "cradle-coupling " + symbol;
  if (effect.kind == "reversal") return "reversal " + symbol;
  return "thermal-drift " + symbol.substr(0, 2) + symbol.substr(3);
}

TEST(RotaryCampaigns, EveryKindMeetsEveryStructureAndHasItsName) {
  std::set<std::pair<std::string, std::string>> met;
  for (int index = 0; index < 16; ++index) {
    const PlannedCampaign plan = plan_campaign("rotary", index, 1, kReadings, 0);
    ASSERT_EQ(plan.hidden.size(), 1U);
    const sim::HiddenEffect& effect = plan.hidden.front().effect;
    EXPECT_GE(plan.hidden.front().signal, 5.0);
    met.emplace(effect.kind, plan.study.machine.structure.code);
    sim::Study study = plan.study;
    study.hidden = {effect};
    study.hidden.front().amplitude = 10e-6;
    study.unseen = false;
    study.validation.points = 10;
    const sim::SimulatedCampaign simulated = sim::simulate(study);
    EXPECT_NEAR(static_cast<double>(simulated.campaign.reading_count()), kReadings, 0.2 * kReadings);
    const RightAnswer right = right_answer(effect, simulated.campaign);
    ASSERT_TRUE(right.name) << text_of(effect);
    EXPECT_EQ(right.name->kind + " " + right.name->target.name(), expected_name(effect)) << text_of(effect);
    if (effect.kind == "worm") {
      EXPECT_EQ(*right.spec->options.number("period"), *effect.options.number("period"));
    }
    if (effect.kind == "squareness-channel") {
      EXPECT_EQ(right.name->driver.name(), "T_" + *effect.options.text("channel"));
    }
  }
  EXPECT_EQ(met.size(), 16U);
}

TEST(RotaryCampaigns, NothingIsHiddenUnderEveryKindOfNoise) {
  std::set<std::string> noises;
  for (int index = 0; index < 5; ++index) {
    const PlannedCampaign plan = plan_campaign("rotary-null", index, 1, kReadings, 0);
    EXPECT_TRUE(plan.hidden.empty());
    EXPECT_TRUE(plan.given.functions.empty());
    noises.insert(plan.noise);
  }
  EXPECT_EQ(noises.size(), 5U);
}

/// The readings of both axes, and a model that has the linear axes' errors alone.
TEST(RotaryCampaigns, TheModelLacksTheRotaryErrors) {
  PlannedCampaign plan = plan_campaign("rotary-missing", 0, 1, kReadings, 0);
  EXPECT_TRUE(plan.hidden.empty());
  plan.study.unseen = false;
  const Campaign campaign = sim::simulate(plan.study).campaign;
  const auto names_of_rotary_axes = [&](const ModelSpec& spec) {
    const MeasurementModel model(campaign, resolve_knots(spec, campaign));
    int functions = 0, locations = 0;
    for (const AxisName axis : {AxisName::A, AxisName::C}) {
      for (const Component component : kAllComponents) {
        functions += model.layout().find(ErrorSymbol{component, axis}) ? 1 : 0;
        locations += model.layout().find_location({component, axis}) ? 1 : 0;
      }
    }
    return std::pair(functions, locations);
  };
  EXPECT_EQ(names_of_rotary_axes(plan.given), std::pair(0, 0));
  EXPECT_EQ(names_of_rotary_axes({}).first, 12);
  EXPECT_GE(names_of_rotary_axes({}).second, 8) << "minimal location errors of two rotary axes";
  EXPECT_GT(plan.study.measurements.size(), 1U);
}

}  // namespace
}  // namespace volcal::studies
