// Laws of what a user asks about, on campaigns of sim/ whose effects no catalogue holds.

#include "volcal/identify/criticism/formulas/formula_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/search_states.h"
#include "volcal/identify/criticism/search/surface_search.h"
#include "volcal/model/effects/effect_keys.h"
#include "volcal/model/effects/kinds/open/custom.h"
#include "volcal/model/effects/registry.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using testing_support::FittedStudy;
using testing_support::hiding;
using testing_support::setting_of;

const Eigen::Vector3i kFormulaGrid{5, 4, 4};

EffectSpec surface_of(const std::string& target, const std::string& drivers) {
  return effect_spec("empirical", {{"target", target}, {"drivers", drivers}});
}

/// A tilt by a temperature that grows along Y.
const FittedStudy& study_of_growing_tilt() {
  static const FittedStudy study([] {
    sim::HiddenEffect effect{.kind = "thermal-tilt", .options = {}, .rms = 3.0e-6};
    effect.options.set("symbol", std::string("EAZ"));
    effect.options.set("channel", std::string("column"));
    effect.options.set("by", std::string("Y"));
    sim::Study hidden = hiding({effect}, kFormulaGrid);
    hidden.environment.channels[0].amplitude = 1.0;  // so that time is no temperature
    return hidden;
  }());
  return study;
}

const ModelState& state_of_growing_tilt() {
  static const ModelState state(study_of_growing_tilt().model, setting_of(study_of_growing_tilt().model));
  return state;
}

/// Variables of its expression.
std::vector<std::string> variables_of(const FormulaFinding& law) {
  std::vector<std::string> names;
  const auto expression = custom_expression(*law.spec.options.text("expression"));
  for (const std::string& name : expression.variables()) {
    if (name != "p" && name != "q") names.push_back(name);
  }
  std::ranges::sort(names);
  return names;
}

const std::vector<std::string> kOfTilt = {"T_column", "y"};

/// Among three drivers of which the law has two.
TEST(FormulaSearch, FindsALawAmongThreeDrivers) {
  const AskedLaws asked = asked_laws(state_of_growing_tilt(), surface_of("EAZ", "x y T_column"));
  EXPECT_THAT(asked.label, HasSubstr("EAZ by x y T_column"));
  EXPECT_GT(asked.tried, 500u);
  ASSERT_GE(asked.laws.size(), 2u);
  EXPECT_GE(asked.sufficient(), 1u);
  const FormulaFinding& best = asked.laws.front();
  EXPECT_EQ(variables_of(best), kOfTilt) << best.label;
  EXPECT_LT(best.log10_p, -20.0);
  EXPECT_GT(std::abs(best.amplitude), 10.0 * best.u);
  for (std::size_t i = 1; i < asked.laws.size(); ++i)
    EXPECT_LE(asked.laws[i].log_evidence, asked.laws[i - 1].log_evidence);
}

/// A surface of the temperature alone sees a part of it; the law is longer than the surface.
TEST(FormulaSearch, MultipliesALawWithAFurtherVariable) {
  const AskedLaws asked = asked_laws(state_of_growing_tilt(), surface_of("EAZ", "T_column"));
  ASSERT_FALSE(asked.laws.empty());
  EXPECT_EQ(variables_of(asked.laws.front()), kOfTilt) << asked.laws.front().label;
  EXPECT_GT(asked.laws.front().log_evidence, asked.surface_evidence + 10.0);
}

/// With the surface in the model nothing is left beside it.
TEST(FormulaSearch, LooksInThePlaceOfASurfaceOfTheSameVariables) {
  const ModelState& before = state_of_growing_tilt();
  SurfaceTest drawn;
  const EffectKind& kind = *find_effect("empirical");
  drawn.spec = kind.resolved(surface_of("EAZ", "y T_column"), before.model().views(), {});
  drawn.effect = kind.make(drawn.spec, {});
  drawn.finding.variables = variables_in("y T_column");
  const ModelState with = before.with_surface(drawn, {});
  ASSERT_EQ(with.surfaces().size(), 1u);
  for (const char* drivers : {"y T_column", "T_column y"}) {
    const AskedLaws asked = asked_laws(with, surface_of("EAZ", drivers));
    EXPECT_EQ(asked.label, "surface EAZ by y T_column");
    EXPECT_GT(asked.surface_evidence, 20.0) << drivers;
    ASSERT_FALSE(asked.laws.empty());
    EXPECT_EQ(variables_of(asked.laws.front()), kOfTilt) << asked.laws.front().label;
    EXPECT_LT(asked.laws.front().log10_p, -20.0) << drivers;
  }
  EXPECT_LT(asked_laws(with, surface_of("EAZ", "y")).surface_evidence, 5.0) << "beside it nothing is left";
}

TEST(FormulaSearch, KnowsAFunctionOfTheSameVariables) {
  const EffectSpec drawn = surface_of("EAZ", "y T_column");
  EXPECT_TRUE(is_same_function(drawn, surface_of("EAZ", "T_column y")));
  EXPECT_FALSE(is_same_function(drawn, surface_of("EAY", "y T_column")));
  EXPECT_FALSE(is_same_function(drawn, surface_of("EAZ", "y")));
  EffectSpec reversing = drawn;
  reversing.options.set("factor", std::string("dir_y dir_x"));
  EXPECT_FALSE(is_same_function(drawn, reversing));
  EffectSpec turned = reversing;
  turned.options.set("factor", std::string("dir_x dir_y"));
  EXPECT_TRUE(is_same_function(reversing, turned));
  EffectSpec in_part = drawn;
  in_part.options.set("only", std::string("tool short"));
  EXPECT_FALSE(is_same_function(drawn, in_part));
}

/// gain = 2 (log evidence + ln tried): the price of the choice is the only difference.
TEST(FormulaSearch, PaysForWhatWasTried) {
  const AskedLaws asked = asked_laws(state_of_growing_tilt(), surface_of("EAZ", "y T_column"));
  ASSERT_FALSE(asked.laws.empty());
  // 11 functions of each of two drivers with 9 of at most one and 2 of two parameters of their shape
  std::size_t by_hand = 0;
  for (const int first : {0, 0, 0, 1, 1, 1, 1, 1, 1, 2, 2}) {
    for (const int second : {0, 0, 0, 1, 1, 1, 1, 1, 1, 2, 2}) by_hand += first + second <= 2 ? 1 : 0;
  }
  EXPECT_EQ(asked.tried, by_hand);
  const auto of_two = std::ranges::find_if(
      asked.laws, [](const FormulaFinding& law) { return variables_of(law) == kOfTilt; });
  ASSERT_NE(of_two, asked.laws.end());
  EXPECT_NEAR(of_two->gain, 2.0 * (of_two->log_evidence + std::log(static_cast<double>(by_hand))), 1e-6);
}

/// A backlash, asked as a function of the travel since turning: the law is the direction alone.
TEST(FormulaSearch, MayFindTheDirectionAlone) {
  const FittedStudy study(hiding({testing_support::reversal("EXX", 1.5e-6)}, {5, 4, 3}));
  const ModelState state(study.model, setting_of(study.model));
  EffectSpec surface = surface_of("EXX", "since_x");
  surface.options.set("factor", std::string("dir_x"));
  const AskedLaws asked = asked_laws(state, surface);
  ASSERT_FALSE(asked.laws.empty());
  EXPECT_EQ(*asked.laws.front().spec.options.text("expression"), "dir_x");
}

TEST(FormulaSearch, RefusesWhatCannotAct) {
  const LinearModel& model = study_of_growing_tilt().model;
  EXPECT_NO_THROW(check_asked_surface(model, surface_of("EAZ", "y")));
  EXPECT_THROW(check_asked_surface(model, surface_of("EAZ", "T_spindle")), InputError);
  EXPECT_THROW(check_asked_surface(model, surface_of("EAZ", "x y z t")), InputError);
  EffectSpec in_part = surface_of("EAZ", "y");
  in_part.options.set("only", std::string("tool ") + model.campaign().machine.tools.front().name);
  EXPECT_THROW(check_asked_surface(model, in_part), InputError);
}

}  // namespace
}  // namespace volcal
