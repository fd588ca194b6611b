// One cause over all tools: a load in proportion to their length.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/effect_campaign.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

/// Lengths by hand: 0.1 m, |(0.15, 0.05, -0.2)| = 0.254951 m, |(0, 0.3, -0.4)| = 0.5 m.
Campaign with_three_tools() {
  Campaign campaign = testing_support::effect_campaign();
  campaign.machine.tools.push_back({"long", {0.0, 0.3, -0.4}, 0.0});
  campaign.setups[2].tool = 2;
  return campaign;
}

std::size_t loads_by_length(const Campaign& campaign) {
  const EffectKind& kind = *find_effect("tool-load");
  const auto specs = kind.candidates(campaign);
  return static_cast<std::size_t>(
      std::ranges::count_if(specs, [&](const EffectSpec& spec) { return !spec.options.has("tool"); }));
}

TEST(ToolLoad, GrowsWithTheLengthOfTheTool) {
  const Campaign campaign = with_three_tools();
  ModelSpec spec;
  spec.default_function.basis = "zero";
  const MeasurementModel model(campaign, spec);
  const auto effect =
      find_effect("tool-load")->make(effect_spec("tool-load", {{"symbol", std::string("EBX")}}), {});
  EXPECT_EQ(effect->name().driver.name(), "tool_length");
  EXPECT_EQ(effect->amplitudes().front().key, "amplitude_urad_per_m");
  const double by_hand[] = {0.1, 0.2549510, 0.5};
  const auto views = setup_views(campaign, model.binding(), model.chain());
  for (std::size_t setup = 0; setup < 3; ++setup)
    EXPECT_NEAR(effect->drivers(views[setup], effect->shape_values())(4, 0), by_hand[setup], 1e-6);
}

/// Of two tools a load of one is a load by length; of tools of one length none is.
TEST(ToolLoad, IsOfferedByLengthForThreeToolsThatDiffer) {
  EXPECT_EQ(loads_by_length(with_three_tools()), 9u);  // three rotations of three axes
  EXPECT_EQ(loads_by_length(testing_support::effect_campaign()), 0u);
  Campaign alike = with_three_tools();
  alike.machine.tools[2].offset = {0.0, 0.0, 0.1};
  EXPECT_EQ(loads_by_length(alike), 0u);
}

}  // namespace
}  // namespace volcal
