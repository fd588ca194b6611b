// Steps of a session that cannot be taken, or are taken back: what stays as it was.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "tests/support/hidden_studies.h"
#include "volcal/identify/session/session.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

const EffectName kOfY = EffectName::of_parts("reversal", "EYY", "dir_y", "step");

/// Two reversals hidden.
class SessionSteps : public ::testing::Test {
 protected:
  static const Campaign& campaign() {
    static const Campaign made =
        sim::simulate(testing_support::hiding({testing_support::reversal("EYY", 1.0e-6),
                                               testing_support::reversal("EXX", 0.6e-6)},
                                              {5, 4, 4}))
            .campaign;
    return made;
  }
  static std::unique_ptr<Session> open(const ModelSpec& model = testing_support::polynomials()) {
    SessionOptions options;
    options.threads = 1;
    return std::make_unique<Session>(campaign(), model, options);
  }
  static EffectSpec of_y(const std::string& expression) {
    return effect_spec("custom", {{"target", std::string("EYY")}, {"expression", expression}});
  }
  static EffectSpec wave(double p, double sigma = 0.0) {
    EffectSpec spec = of_y("dir_y * cos(y / p)");
    spec.options.set("p", p);
    if (sigma > 0.0) spec.options.set("p_sigma", sigma);
    return spec;
  }
  static std::string refusal(const std::function<void()>& step) {
    try {
      step();
    } catch (const InputError& error) {
      return error.problem() + "; " + error.remedy();
    }
    return "";
  }
  static std::vector<bool> first(const Session& session, std::size_t count) {
    std::vector<bool> marked(session.linear().size(), false);
    std::fill_n(marked.begin(), std::min(count, marked.size()), true);
    return marked;
  }
};

TEST_F(SessionSteps, AFormulaThatIsNotFiniteIsForgotten) {
  const auto own = open();
  EXPECT_THAT(refusal([&] { own->formula(of_y("dir_y * sqrt(0 - 1 - abs(y))")); }), HasSubstr("not finite"));
  EXPECT_THAT(refusal([&] { own->formula(wave(0.0)); }), HasSubstr("not finite"));
  EXPECT_THAT(refusal([&] { own->formula(of_y("dir_y * 1e300")); }), HasSubstr("smaller numbers"));
  EXPECT_EQ(own->tried(), 0U);
  EXPECT_FALSE(own->rank().empty());
  const EffectPreview right = own->formula(of_y("dir_y / 2"));
  EXPECT_EQ(own->tried(), 1U);
  EXPECT_EQ(own->add(right.effect.name).effects.size(), 1U);
  EXPECT_FALSE(own->rank().empty());
}

TEST_F(SessionSteps, AnotherValueOfAParameterIsAnotherTest) {
  const auto own = open();
  const EffectPreview near = own->formula(wave(30.0)), far = own->formula(wave(90.0));
  EXPECT_NE(near.effect.name, far.effect.name);
  EXPECT_NE(near.effect.amplitudes[0].value, far.effect.amplitudes[0].value);
  own->formula(wave(30.0));
  EXPECT_EQ(own->tried(), 2U) << "the same again is no test";
  own->formula(wave(30.0, 5.0));
  own->formula(wave(90.0, 5.0));
  EXPECT_EQ(own->tried(), 4U);
  const SessionModel& added = own->add(own->formula(wave(90.0, 5.0)).effect.name);
  EXPECT_EQ(added.effects[0].spec.options.number("p_sigma"), 5.0);
  EXPECT_NEAR(*added.effects[0].spec.options.number("p"), 90.0, 30.0) << "what was asked for last";
  EXPECT_THAT(refusal([&] { own->formula(wave(30.0, 5.0)); }), HasSubstr("already"));
  own->go_to(0);
  own->add(near.effect.name);
  own->add(far.effect.name);
  const ModelSpec model = own->model();
  ASSERT_EQ(model.effects.size(), 2U);
  EXPECT_EQ(model.effects[0].options.number("p"), 30.0);
  EXPECT_EQ(model.effects[1].options.number("p"), 90.0);
  EXPECT_EQ(own->take(own->confirmation()).effects.size(), 2U) << "two waves in one model";
}

TEST_F(SessionSteps, ReadingsRemainThatDetermineTheModel) {
  const auto own = open();
  const std::size_t all = own->linear().size();
  const auto without = [&](std::size_t count) {
    return refusal([&] { own->take(own->leaving_out(first(*own, count), "wrong")); });
  };
  EXPECT_THAT(without(all), HasSubstr("no reading would remain"));
  EXPECT_THAT(without(all - 10), HasSubstr("10 readings would remain, and this model needs more than"));
  EXPECT_EQ(own->models().size(), 1U);
  EXPECT_EQ(without(5), "");
  EXPECT_EQ(own->models().size(), 2U);
}

/// Against the least noise of fits of the same readings.
TEST_F(SessionSteps, ABranchOfOtherReadingsLeavesFiguresAsTheyWere) {
  const auto own = open();
  own->add(kOfY);
  const LadderStep given = own->models()[0].figures, added = own->models()[1].figures;
  own->take(own->leaving_out(first(*own, own->linear().size() / 3), "tracker unstable"));
  for (const auto& [number, before] : {std::pair{0U, given}, std::pair{1U, added}}) {
    EXPECT_EQ(own->models()[number].figures.systematic, before.systematic) << number;
    EXPECT_EQ(own->models()[number].figures.reduced_chi2, before.reduced_chi2) << number;
  }
  own->undo();
  own->take(own->confirmation());
  EXPECT_NEAR(own->current().figures.reduced_chi2, 1.0, 0.3) << "against its own readings' noise";
}

TEST_F(SessionSteps, EffectsOfTheGivenModelAreListedAndTakenOut) {
  ModelSpec with = testing_support::polynomials();
  const EffectSpec given = effect_spec("reversal", {{"symbol", std::string("EYY")}, {"amplitude", 0.7e-6}});
  with.effects.push_back(given);
  const auto own = open(with);
  ASSERT_EQ(own->current().effects.size(), 1U);
  const EffectFinding listed = own->current().effects[0];
  EXPECT_EQ(listed.name, kOfY);
  EXPECT_TRUE(own->was_given(kOfY));
  EXPECT_FALSE(own->is_preview(kOfY));
  EXPECT_GT(listed.amplitudes.at(0).u, 0.0);
  EXPECT_TRUE(std::isnan(listed.log10_p)) << "no test was made of it";
  own->add(EffectName::of_parts("reversal", "EXX", "dir_x", "step"));
  own->take(own->confirmation());
  ASSERT_EQ(own->model().effects.size(), 2U);
  EXPECT_EQ(own->model().effects[0].options.number("amplitude"), given.options.number("amplitude"))
      << "as it was given";
  own->go_to(0);
  const SessionModel& without = own->take(own->removal(kOfY));
  EXPECT_TRUE(without.effects.empty());
  EXPECT_TRUE(own->model().effects.empty());
  EXPECT_EQ(own->residual(), open()->residual()) << "the model without it, to the bit";
}

TEST_F(SessionSteps, WhatIsConfirmedKeepsTheTestThatItWasAddedBy) {
  const auto own = open();
  const EffectFinding found = own->preview(kOfY).effect;
  own->add(kOfY);
  const EffectFinding confirmed = own->take(own->confirmation()).effects.at(0);
  EXPECT_EQ(confirmed.log10_p, found.log10_p);
  EXPECT_EQ(confirmed.gain, found.gain);
  EXPECT_EQ(confirmed.visible_fraction, found.visible_fraction);
}

TEST_F(SessionSteps, GoingToAModelIsUndone) {
  const auto own = open();
  own->add(kOfY);
  own->add(EffectName::of_parts("reversal", "EXX", "dir_x", "step"));
  own->undo();
  own->go_to(0);
  EXPECT_TRUE(own->can_undo());
  EXPECT_TRUE(own->can_redo());
  EXPECT_TRUE(own->undo());
  EXPECT_EQ(own->current().number, 1U);
  EXPECT_TRUE(own->redo());
  EXPECT_EQ(own->current().number, 0U);
  EXPECT_TRUE(own->redo());
  EXPECT_EQ(own->current().number, 2U) << "what was undone before is not lost";
}

TEST_F(SessionSteps, WhatTheReadingsDoNotShowIsNotAdded) {
  const auto own = open();
  const EffectFinding nothing = own->formula(of_y("0 * dir_y")).effect;
  const EffectFinding course = own->formula(of_y("y")).effect;
  EXPECT_EQ(nothing.dof, 0);
  EXPECT_EQ(course.dof, 0);
  const std::vector<Explanation> why = own->why_not_visible({nothing, course});
  EXPECT_THAT(why.at(0).reason, HasSubstr("no reading changes"));
  EXPECT_THAT(why.at(1).reason, HasSubstr("can be exchanged with EYY"));
  EXPECT_FALSE(why.at(1).remedy.empty());
  EXPECT_THAT(refusal([&] { own->add(course.name); }), HasSubstr("not visible"));
  EXPECT_EQ(own->models().size(), 1U);
  own->add(kOfY);
  const EffectFinding again = own->formula(of_y("dir_y / 2")).effect;
  EXPECT_EQ(again.dof, 0);
  EXPECT_THAT(own->why_not_visible({again}).at(0).reason, HasSubstr("reversal EYY"));
}

}  // namespace
}  // namespace volcal
