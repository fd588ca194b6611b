// An adjustment that goes astray, and steps of shapes that would lead there.

#include "volcal/identify/solve/plausibility.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/effect_campaign.h"
#include "tests/support/refusal.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/kinds/open/custom.h"

namespace volcal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A time constant of 1800 s, readings within 500 s.
class TimeConstant : public ::testing::Test {
 protected:
  static ModelSpec growth() {
    ModelSpec spec;
    spec.default_function.basis = "zero";
    spec.effects.push_back(written_spec("EXX", "1 - exp(-t / p)"));
    spec.effects.back().options.set("p", 1800.0);
    spec.effects.back().options.set("p_sigma", 600.0);
    return spec;
  }
  Eigen::Index p() const { return model_.layout().find_block("EXX by 1 - exp(-t / p): p")->offset; }
  Eigen::VectorXd with_p(double value) const {
    Eigen::VectorXd parameters = model_.initial_parameters();
    parameters[p()] = value;
    return parameters;
  }

  Campaign campaign_ = testing_support::effect_campaign();
  MeasurementModel model_{campaign_, growth()};
};

TEST_F(TimeConstant, FollowsItsExpansionOnThisSideOfZero) {
  EXPECT_TRUE(model_.follow_expansion(with_p(1800.0)));
  EXPECT_TRUE(model_.follow_expansion(with_p(1500.0)));
  for (const double beyond : {0.0, -1.0, -30.0, -2000.0})
    EXPECT_FALSE(model_.follow_expansion(with_p(beyond))) << beyond;
}

TEST_F(TimeConstant, GoesAPartOfTheWayAndThenOn) {
  Eigen::VectorXd near = with_p(1500.0);
  model_.approach_effects(near);
  EXPECT_EQ(near, with_p(1500.0)) << "nothing is set back that follows";
  Eigen::VectorXd far = with_p(-30.0);
  model_.approach_effects(far);
  EXPECT_GT(far[p()], 0.0);
  EXPECT_LT(far[p()], 1500.0);
  EXPECT_TRUE(model_.follow_expansion(far)) << "the expansion stands there";
}

TEST_F(TimeConstant, IsNamedWhereItLeadsAstray) {
  std::vector<SetupSummary> setups(1);
  setups[0].name = "P1";
  setups[0].reading_unit = "um";
  setups[0].rms_residual = 1e-6;
  EXPECT_EQ(testing::refusal([&] { require_plausible_fit(model_, with_p(-27.0), setups); }), "");
  setups[0].rms_residual = 10.0;
  EXPECT_THAT(
      testing::refusal([&] { require_plausible_fit(model_, with_p(-27.0), setups); }),
      AllOf(HasSubstr("the adjustment went astray"), HasSubstr("\"P1\" by 10000 mm RMS"),
            HasSubstr("\"EXX by 1 - exp(-t / p): p\" from 1800 to -27"), HasSubstr("hold this parameter")));
}

}  // namespace
}  // namespace volcal
