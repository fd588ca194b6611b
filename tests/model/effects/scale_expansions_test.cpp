// Which effects expand scales, asked of their drivers: on positioning errors alone, in proportion to the
// distance from home and to the temperature's excess over 20 degC.

#include "volcal/model/effects/scale_expansions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "tests/support/effect_campaign.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// With every temperature at one value.
Campaign everywhere_at(Campaign campaign, double temperature_degC) {
  for (Setup& setup : campaign.setups) {
    for (auto& [channel, values] : setup.readings.temperature) std::ranges::fill(values, temperature_degC);
  }
  return campaign;
}

Eigen::MatrixXd drivers_at(const Effect& effect, const Campaign& campaign, double temperature_degC) {
  const Campaign warm = everywhere_at(campaign, temperature_degC);
  const SetupView view{warm, warm.setups.front(), {}, {}};
  return effect.drivers(view, effect.shape_values());
}

/// Distance from home times excess, for every term.
bool expands_by_its_drivers(const Effect& effect, const Campaign& campaign) {
  const std::vector<EffectTerm> terms = effect.terms();
  const bool on_positioning = std::ranges::all_of(terms, [](const EffectTerm& term) {
    return term.target.kind == TargetKind::Motion && term.target.symbol.is_positioning() &&
           !is_rotary(term.target.symbol.axis);
  });
  if (!on_positioning || terms.empty()) return false;
  const Eigen::MatrixXd drivers = drivers_at(effect, campaign, 23.0);
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const AxisName axis = terms[k].target.symbol.axis;
    const auto& position = campaign.setups.front().readings.position[index_of(axis)];
    for (std::size_t row = 0; row < position.size(); ++row) {
      const double strain = 3.0 * (position[row] - campaign.machine.axis(axis).home);
      if (std::abs(drivers(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k)) - strain) > 1e-12)
        return false;
    }
  }
  return drivers_at(effect, campaign, 20.0).isZero(1e-12);
}

TEST(ScaleExpansions, AreThoseOfEveryKindWhoseDriversDoSo) {
  const Campaign campaign = testing_support::effect_campaign();
  std::set<std::string> expanding;
  for (const EffectKind* kind : effect_kinds()) {
    if (kind->schema().kind == "custom" || kind->schema().kind == "empirical") continue;  // written freely
    for (const EffectSpec& spec : kind->examples(campaign)) {
      const std::unique_ptr<Effect> effect = kind->make(spec, "model.toml");
      const bool by_drivers = expands_by_its_drivers(*effect, campaign);
      EXPECT_EQ(!expansion_channels(*effect).empty(), by_drivers) << full_name(effect->name());
      if (by_drivers) expanding.insert(kind->schema().kind);
    }
  }
  EXPECT_THAT(expanding, ElementsAre("common-expansion", "scale-expansion"));
}

TEST(ScaleExpansions, AreOfTheMachineFileAndOfEffects) {
  Machine machine = testing_support::effect_campaign().machine;
  EXPECT_THAT(expansion_channels(machine, ModelSpec{}), IsEmpty());
  machine.axes[1].expansion = ScaleExpansion{10e-6, 0.0, "spindle"};
  ModelSpec model;
  model.effects = {
      effect_spec("common-expansion", {{"axes", std::string("X Y")}, {"temperature", std::string("air")}}),
      effect_spec("thermal-drift", {{"symbol", std::string("EAY")}, {"temperature", std::string("bed")}})};
  EXPECT_THAT(expansion_channels(machine, model), ElementsAre("air", "spindle"));
}

}  // namespace
}  // namespace volcal
