// One cause on several axes: one amplitude, a driver for each.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "tests/support/refusal.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/effects/shared_motions.h"

namespace volcal {
namespace {

std::unique_ptr<Effect> common_effect(const EffectSpec& spec) {
  return find_effect(spec.kind)->make(spec, "model.toml");
}

/// Two readings, 10 min apart, at x = 0.1 and 0.3 m, y = -0.2 m, 22 and 23 degC, approached + + and - +.
Campaign readings_ten_minutes_apart() {
  Campaign campaign;
  campaign.machine = testing_support::effect_campaign().machine;
  Setup& setup = campaign.setups.emplace_back();
  Readings& readings = setup.readings;
  for (const AxisName axis : kLinearAxes) {
    readings.position[index_of(axis)] = {0.0, 0.0};
    readings.direction[index_of(axis)] = {1, 1};
  }
  readings.position[index_of(AxisName::X)] = {0.1, 0.3};
  readings.position[index_of(AxisName::Y)] = {-0.2, -0.2};
  readings.direction[index_of(AxisName::X)] = {1, -1};
  readings.time = {0.0, 600.0};
  readings.temperature["frame"] = {22.0, 23.0};
  readings.value = {{0.0, 0.0}};
  readings.source_line = {2, 3};
  return campaign;
}

double home_in(const Campaign& campaign, AxisName axis) { return campaign.machine.axis(axis).home; }

TEST(CommonEffects, ReversalJumpsOnEveryAxisByItsOwnDirection) {
  const Campaign campaign = readings_ten_minutes_apart();
  const SetupView view{campaign, campaign.setups[0], {}, {}};
  const auto effect =
      common_effect(effect_spec("common-reversal", {{"symbols", std::string("EXX EYY EYX")}}));
  ASSERT_EQ(effect->amplitudes().size(), 1U);
  EXPECT_EQ(effect->amplitudes()[0].label, "common reversal of EXX EYY EYX");
  EXPECT_EQ(effect->amplitudes()[0].key, "amplitude_um");
  EXPECT_EQ(effect->name(), EffectName::of_parts("common-reversal", "EXX EYY EYX", "dir_x dir_y", "step"));
  Eigen::MatrixXd halves(2, 3);
  halves << 0.5, 0.5, 0.5, -0.5, 0.5, -0.5;
  EXPECT_EQ(effect->drivers(view, {}), halves);
  const auto terms = effect->terms();
  ASSERT_EQ(terms.size(), 3U);
  EXPECT_EQ(terms[2].target.symbol, (ErrorSymbol{Component::Y, AxisName::X}));
  EXPECT_EQ(terms[2].amplitude, 0U);
}

TEST(CommonEffects, ExpansionStretchesEveryScaleFromItsHome) {
  const Campaign campaign = readings_ten_minutes_apart();
  const SetupView view{campaign, campaign.setups[0], {}, {}};
  const auto effect = common_effect(
      effect_spec("common-expansion", {{"axes", std::string("X Y")}, {"temperature", std::string("frame")}}));
  const Eigen::MatrixXd strains = effect->drivers(view, {});
  EXPECT_DOUBLE_EQ(strains(0, 0), 2.0 * (0.1 - home_in(campaign, AxisName::X)));
  EXPECT_DOUBLE_EQ(strains(1, 0), 3.0 * (0.3 - home_in(campaign, AxisName::X)));
  EXPECT_DOUBLE_EQ(strains(1, 1), 3.0 * (-0.2 - home_in(campaign, AxisName::Y)));
  EXPECT_EQ(effect->amplitudes()[0].unit(), "um/m/K");
}

TEST(CommonEffects, GrowthEndsAtItsAmplitude) {
  const Campaign campaign = readings_ten_minutes_apart();
  const SetupView view{campaign, campaign.setups[0], {}, {}};
  const auto effect =
      common_effect(effect_spec("common-growth", {{"axes", std::string("X Y")}, {"time_constant", 600.0}}));
  const Eigen::MatrixXd growth = effect->drivers(view, effect->shape_values());
  EXPECT_EQ(growth(0, 0), 0.0);
  EXPECT_NEAR(growth(1, 0), (0.3 - home_in(campaign, AxisName::X)) * 0.6321205588, 1e-10);
  EXPECT_NEAR(growth(1, 1), (-0.2 - home_in(campaign, AxisName::Y)) * 0.6321205588, 1e-10);
}

TEST(CommonEffects, ATermAloneIsAnEffectOfOneAxis) {
  const Campaign campaign = readings_ten_minutes_apart();
  const SetupView view{campaign, campaign.setups[0], {}, {}};
  const auto terms =
      single_terms(common_effect(effect_spec("common-reversal", {{"symbols", std::string("EXX EYY")}})));
  ASSERT_EQ(terms.size(), 2U);
  EXPECT_EQ(terms[0]->drivers(view, {}), Eigen::Vector2d(0.5, -0.5));
  EXPECT_EQ(terms[1]->drivers(view, {}), Eigen::Vector2d(0.5, 0.5));
  EXPECT_EQ(terms[1]->amplitudes()[0].target.symbol, (ErrorSymbol{Component::Y, AxisName::Y}));
  EXPECT_EQ(terms[1]->amplitudes()[0].label, "common reversal of EXX EYY");
  EXPECT_EQ(single_terms(common_effect(effect_spec("spindle-growth", {}))).size(), 1U)
      << "one target an amplitude";
}

/// An axis that stands still, or is always approached from one side, shows nothing of a shared cause.
TEST(CommonEffects, CandidatesAreTheAxesThatShowIt) {
  Campaign campaign = readings_ten_minutes_apart();
  EXPECT_EQ(axes_that_move(campaign), std::vector{AxisName::X});
  EXPECT_TRUE(find_effect("common-expansion")->candidates(campaign).empty());
  campaign.setups[0].readings.position[index_of(AxisName::Z)] = {0.0, -0.1};
  campaign.setups[0].readings.direction[index_of(AxisName::Z)] = {-1, 1};
  campaign.setups[0].readings.direction[index_of(AxisName::Y)] = {0, 1};
  const auto expansions = find_effect("common-expansion")->candidates(campaign);
  ASSERT_EQ(expansions.size(), 1U);
  EXPECT_EQ(names_of_symbols(positioning_errors(axes_that_move(campaign))),
            common_effect(expansions[0])->name().target.name());
  const auto reversals = find_effect("common-reversal")->candidates(campaign);
  ASSERT_EQ(reversals.size(), 1U);
  EXPECT_EQ(common_effect(reversals[0])->name().target.name(), "EXX EZZ");
}

TEST(CommonEffects, RefuseWhatIsNoSharedCause) {
  const auto refused = [](const EffectSpec& spec) {
    try {
      common_effect(spec);
      ADD_FAILURE() << "accepted";
    } catch (const InputError& error) {
      EXPECT_FALSE(error.remedy().empty());
    }
  };
  for (const char* symbols : {"EXX", "EXX EXX", "EXX ECX", "EXX EXQ", ""})
    refused(effect_spec("common-reversal", {{"symbols", std::string(symbols)}}));
  for (const char* axes : {"X", "X X", "X C", "XY"})
    refused(effect_spec("common-growth", {{"axes", std::string(axes)}}));
}

}  // namespace
}  // namespace volcal
