/// A spindle that is out of tram, by hand.

#include <gtest/gtest.h>

#include "tests/support/effect_campaign.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

class SpindleDirection : public ::testing::Test {
 protected:
  SpindleDirection() : campaign_(testing_support::effect_campaign()) {
    campaign_.machine.tools = {
        {"short", {0.0, 0.0, -0.1}}, {"side", {0.05, -0.02, -0.2}}, {"long", {0.0, 0.0, -0.3}}};
    for (std::size_t i = 0; i < campaign_.setups.size(); ++i) campaign_.setups[i].tool = i % 2;
    model_.default_function.basis = "zero";
  }
  std::size_t candidates() const { return find_effect("spindle-direction")->candidates(campaign_).size(); }

  Campaign campaign_;
  ModelSpec model_;
};

/// t x o of the side tool, o = (50, -20, -200) mm: about x (0, 200, -20), about y (-200, 0, -50), about z
/// (20, 50, 0) um per mrad.
TEST_F(SpindleDirection, TurnsTheOffsetsOfTools) {
  const auto effect =
      find_effect("spindle-direction")->make(effect_spec("spindle-direction", {}), "model.toml");
  const MeasurementModel model(campaign_, model_);
  const auto views = setup_views(campaign_, model.binding(), model.chain());
  const Eigen::MatrixXd drivers = effect->drivers(views[1], effect->shape_values());
  ASSERT_EQ(effect->terms().size(), 6U);
  Eigen::Matrix3d moved = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < 6; ++k) {
    const EffectTerm term = effect->terms()[k];
    moved(term.target.component, static_cast<Eigen::Index>(term.amplitude)) +=
        drivers(0, static_cast<Eigen::Index>(k));
  }
  Eigen::Matrix3d by_hand;
  by_hand << 0.0, -0.2, 0.02,  //
      0.2, 0.0, 0.05,          //
      -0.02, -0.05, 0.0;
  EXPECT_LT((moved - by_hand).norm(), 1e-15);
}

/// With two tools it is the offset of one of them.
TEST_F(SpindleDirection, IsLookedForWithThreeToolsOrMore) {
  EXPECT_EQ(candidates(), 0U);
  campaign_.setups[0].tool = 2;
  EXPECT_EQ(candidates(), 1U);
  campaign_.machine.tools[2].offset = campaign_.machine.tools[1].offset;
  EXPECT_EQ(candidates(), 0U) << "another name for the same point";
}

}  // namespace
}  // namespace volcal
