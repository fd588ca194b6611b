/// One way to extend a model: what diagnose, extend and try add, with the same checks.

#include "volcal/identify/criticism/model_extension.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/effect_campaign.h"
#include "volcal/identify/criticism/catalogue/left_out.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

class ModelExtension : public ::testing::Test {
 protected:
  std::unique_ptr<Effect> extend(const EffectSpec& spec, bool with_campaign = true) {
    return extend_model({model_, campaign_.machine, with_campaign ? &campaign_ : nullptr}, spec, words_);
  }

  void expect_refused(const EffectSpec& spec, const std::string& problem, const std::string& remedy,
                      bool with_campaign = true) {
    const std::size_t effects = model_.effects.size();
    try {
      extend(spec, with_campaign);
      ADD_FAILURE() << spec.kind << " is accepted";
    } catch (const InputError& error) {
      EXPECT_THAT(error.problem(), HasSubstr(problem));
      EXPECT_THAT(error.remedy(), HasSubstr(remedy));
    }
    EXPECT_EQ(model_.effects.size(), effects);
  }

  static EffectSpec left_out(const std::string& symbols) {
    return effect_spec(kLeftOut, {{"symbol", symbols}});
  }

  Campaign campaign_ = testing_support::effect_campaign();
  ModelSpec model_;
  ExtensionWords words_{.label = "this",
                        .place = {"diagnosis", 3},
                        .remedy_if_known = "leave it out",
                        .remedy_if_absent = "take another machine"};
  EffectSpec reversal_ = effect_spec("reversal", {{"symbol", std::string("EYY")}});
};

TEST_F(ModelExtension, AddsAnEffectOnce) {
  const auto effect = extend(reversal_);
  ASSERT_NE(effect, nullptr);
  EXPECT_EQ(effect->name().target.name(), "EYY");
  ASSERT_EQ(model_.effects.size(), 1U);
  EXPECT_EQ(model_.effects.front().kind, "reversal");
  EffectSpec sized = reversal_;
  sized.options.set("amplitude", 3e-6);
  expect_refused(sized, "the model has this already", "leave it out");
  EXPECT_NE(extend(effect_spec("reversal", {{"symbol", std::string("EXX")}})), nullptr);
}

TEST_F(ModelExtension, GivesBackWhatIsLeftOutAndNothingElse) {
  model_.functions[*ErrorSymbol::parse("EBX")].basis = "zero";
  model_.functions[*ErrorSymbol::parse("EAX")].degree = 2;
  model_.locations_off = {*LocationSymbol::parse("EC0Y")};
  EXPECT_EQ(extend(left_out("EAX EBX EC0Y")), nullptr);
  EXPECT_TRUE(model_.effects.empty());
  EXPECT_TRUE(model_.locations_off.empty());
  EXPECT_EQ(model_.function(*ErrorSymbol::parse("EBX")).basis, "bspline");
  EXPECT_EQ(model_.function(*ErrorSymbol::parse("EAX")).degree, 2)
      << "the model had it, as the user wants it";
  expect_refused(left_out("EAX EBX"), "the model has EAX EBX already", "leave it out");
  expect_refused(left_out("EC0Y"), "the model has EC0Y already", "leave it out");
  expect_refused(left_out("EAA"), "the model's machine does not have", "take another machine");
}

TEST_F(ModelExtension, TheMachineMustHaveTheAxis) {
  const EffectSpec turned = effect_spec("reversal", {{"symbol", std::string("ECC")}});
  expect_refused(turned, "acts on an axis that the model's machine does not have", "take another machine",
                 false);
}

TEST_F(ModelExtension, TheKindMustBeKnown) {
  expect_refused(effect_spec("gremlins", {}), "is of a kind of effect that this program does not know",
                 "diagnose --list");
}

/// Without a campaign nothing is known of channels and directions.
TEST_F(ModelExtension, TheEffectMustActInTheCampaign) {
  const EffectSpec oil =
      effect_spec("thermal-drift", {{"symbol", std::string("EAZ")}, {"temperature", std::string("oil")}});
  expect_refused(oil, "oil", "add the column");
  EXPECT_NE(extend(oil, false), nullptr);
  for (volcal::Setup& setup : campaign_.setups)
    std::ranges::fill(setup.readings.direction[1], std::int8_t{1});
  expect_refused(reversal_, "dir_y: the same in all readings", "measure where that changes");
  EXPECT_NE(extend(reversal_, false), nullptr);
}

}  // namespace
}  // namespace volcal
