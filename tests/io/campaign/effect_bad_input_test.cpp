// Effects in model files that must be refused, with file, line and remedy: every kind with its keys broken
// one after the other, and custom effects broken in ways of their own.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "tests/support/schema_samples.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using ::testing::AllOf;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Le;

constexpr int kFirstLine = 5;  // of the effect
const std::string kHead = "format = \"volcal-model-1\"\n\n[functions]\ndefault = { basis = \"zero\" }";

/// What reading the model, and binding it to a campaign that has everything, say; nothing when accepted.
std::optional<InputError> refusal_of_effect(const std::string& effect) {
  static const Campaign campaign = testing_support::five_axis_effect_campaign();
  try {
    const MeasurementModel model(campaign, parse_model(kHead + effect, "model.toml", campaign.machine));
  } catch (const InputError& error) {
    return error;
  }
  return std::nullopt;
}

void expect_refused(const std::string& effect, const std::string& why) {
  const auto error = refusal_of_effect(effect);
  ASSERT_TRUE(error.has_value()) << why << " is accepted:" << effect;
  const auto lines = static_cast<int>(std::ranges::count(effect, '\n'));
  EXPECT_EQ(error->place().file, "model.toml") << effect;
  EXPECT_THAT(error->place().line, AllOf(Ge(kFirstLine), Le(kFirstLine + lines))) << error->what();
  EXPECT_FALSE(error->problem().empty()) << effect;
  EXPECT_FALSE(error->remedy().empty()) << error->what();
}

/// The effect's table with one key's value replaced; without the key when there is no value.
std::string with_value(const std::string& effect, const std::string& key,
                       const std::optional<std::string>& value) {
  const std::size_t begin = effect.find("\n" + key + " = ") + 1;
  const std::size_t end = effect.find('\n', begin);
  if (begin == 0) return effect + key + " = " + value.value_or("1") + "\n";
  return effect.substr(0, begin) + (value ? key + " = " + *value : "# " + key) + effect.substr(end);
}

struct Sample {
  const EffectKind* kind;
  std::string text;
  std::string amplitude;  ///< key of the first one
  std::string one;        ///< value of that key at which every amplitude is 1
};

std::vector<Sample> samples() {
  std::vector<Sample> all;
  for (const EffectKind* kind : effect_kinds()) {
    const EffectSpec spec = kind->examples(testing_support::five_axis_effect_campaign()).front();
    const std::unique_ptr<Effect> effect = kind->make(spec, {});
    const bool list = effect->amplitudes().front().element >= 0;
    all.push_back({kind, effect_toml(spec), effect->amplitudes().front().key,
                   list ? testing::ones(effect->amplitudes().size()) : "1"});
  }
  return all;
}

TEST(EffectBadInput, TheSamplesThemselvesAreAccepted) {
  for (const Sample& sample : samples()) {
    const auto error = refusal_of_effect(with_value(sample.text, sample.amplitude, sample.one));
    EXPECT_FALSE(error.has_value()) << error->what();
  }
}

/// No axis, symbol, tool, station, setup, channel or target is called so.
TEST(EffectBadInput, NamesThatNobodyHas) {
  for (const Sample& sample : samples()) {
    for (const KeySchema& key : sample.kind->schema().keys) {
      if (key.type != KeyType::Text) continue;
      expect_refused(with_value(sample.text, key.key, "\"GREMLIN\""), key.key + " = GREMLIN");
      expect_refused(with_value(sample.text, key.key, "7"), key.key + " = 7");
      expect_refused(with_value(sample.text, key.key, "[1, 2]"), key.key + " = [1, 2]");
    }
  }
}

TEST(EffectBadInput, RequiredKeysThatAreMissing) {
  for (const Sample& sample : samples()) {
    for (const KeySchema& key : sample.kind->schema().keys) {
      if (key.required) expect_refused(with_value(sample.text, key.key, std::nullopt), "no " + key.key);
    }
  }
}

TEST(EffectBadInput, AmplitudesWithoutUnitOfAnotherTypeOrOutOfReason) {
  for (const Sample& sample : samples()) {
    for (const char* value : {"\"1\"", "true", "[1.0]", "nan", "inf", "1e12", "-1e12", "1e-30"}) {
      expect_refused(with_value(sample.text, sample.amplitude, value), sample.amplitude + " = " + value);
    }
    const std::string stem(stem_of_key(sample.amplitude));
    expect_refused(sample.text + stem + " = 1\n", stem + " without a unit");
    expect_refused(sample.text + stem + "_inch = 1\n", stem + " in inches");
    expect_refused(sample.text + "amplitud_um = 1\n", "a misspelt key");
  }
}

/// An amplitude of another effect of the kind: um for a rotation, per kelvin for what follows time.
TEST(EffectBadInput, AmplitudesInTheUnitOfAnother) {
  int tried = 0;
  for (const Sample& sample : samples()) {
    for (const KeySchema& key : sample.kind->schema().keys) {
      if (key.key == sample.amplitude || stem_of_key(key.key) != stem_of_key(sample.amplitude)) continue;
      expect_refused(sample.text + key.key + " = 1\n", key.key);
      ++tried;
    }
  }
  EXPECT_GT(tried, 10);
}

TEST(EffectBadInput, TheSameEffectTwice) {
  for (const Sample& sample : samples()) {
    const auto error = refusal_of_effect(sample.text + sample.text);
    ASSERT_TRUE(error.has_value()) << sample.text;
    EXPECT_THAT(error->problem(), HasSubstr("is given twice"));
  }
}

struct Broken {
  const char* name;
  const char* keys;  ///< of a custom effect, from line 7 on
  int line;
  const char* problem;
  const char* remedy;
};

void PrintTo(const Broken& broken, std::ostream* out) { *out << broken.name; }

class BrokenCustomEffect : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenCustomEffect, IsRefusedWithPlaceProblemAndRemedy) {
  const Broken& broken = GetParam();
  const auto error = refusal_of_effect(std::string("\n[[effects]]\nkind = \"custom\"\n") + broken.keys);
  ASSERT_TRUE(error.has_value()) << "accepted";
  EXPECT_EQ(error->place().line, broken.line) << error->what();
  EXPECT_THAT(error->problem(), HasSubstr(broken.problem));
  EXPECT_THAT(error->remedy(), HasSubstr(broken.remedy));
}

INSTANTIATE_TEST_SUITE_P(
    All, BrokenCustomEffect,
    ::testing::Values(
        Broken{"NoTarget", "expression = \"z\"\n", 5, "key target is missing in effects[1]", "add target"},
        Broken{"NoExpression", "target = \"EAY\"\n", 5, "key expression is missing in effects[1]",
               "add expression"},
        Broken{"WrongTarget", "target = \"EAQ\"\nexpression = \"z\"\n", 5, "\"EAQ\" is not a target",
               "write an error motion (EAY)"},
        Broken{"UnknownVariable", "target = \"EAY\"\nexpression = \"z * height\"\n", 5,
               "at character 5, \"height\"", "T_<channel>"},
        Broken{"UnknownFunction", "target = \"EAY\"\nexpression = \"square(z)\"\n", 5,
               "at character 1, \"square\"", "functions are"},
        Broken{"Parentheses", "target = \"EAY\"\nexpression = \"(z + 1\"\n", 5,
               "its parentheses do not match", "variables are"},
        Broken{"UnknownChannel", "target = \"EAY\"\nexpression = \"T_oil - 20\"\n", 5,
               "column T_oil_degC is missing", "air, spindle"},
        Broken{"AmplitudeInAnotherUnit", "target = \"EAY\"\nexpression = \"z\"\namplitude_um = 1\n", 9,
               "is stated in urad", "write amplitude_urad"},
        Broken{"AmplitudeWithoutUnit", "target = \"EAY\"\nexpression = \"z\"\namplitude = 1\n", 9,
               "unknown key effects[1].amplitude", "amplitude_u"},
        Broken{"ExpressionIsANumber", "target = \"EAY\"\nexpression = 3\n", 8, "expected a text",
               "in double quotes"},
        Broken{"NotFinite", "target = \"EAY\"\nexpression = \"log(x - 300)\"\n", 5, "is not finite at",
               "at every reading"},
        Broken{"ParameterWithoutValue", "target = \"EAY\"\nexpression = \"exp(-t / p)\"\n", 5,
               "uses p, which has no value", "add p = 1.0"},
        Broken{"UnknownStation", "target = \"station P7 x\"\nexpression = \"z\"\n", 5, "a station \"P7\"",
               "P1, P2"},
        Broken{"UnknownTool", "target = \"tool long z\"\nexpression = \"z\"\n", 5, "a tool \"long\"",
               "short, side"}),
    [](const auto& test) { return std::string(test.param.name); });

/// What was written is what is read: quotes, backslashes and identified values included.
TEST(CustomEffectInAFile, RoundTrips) {
  const Campaign campaign = testing_support::five_axis_effect_campaign();
  const std::string text = kHead +
                           "\n[[effects]]\nkind = \"custom\"\ntarget = \"tool side z\"\n"
                           "expression = \"z < 200 ? 0 : (1 - exp(-t / p)) * (T_air - 20)\"\n"
                           "p = 900\np_sigma = 100\namplitude_um = 1.25\n";
  const ModelSpec first = parse_model(text, "model.toml", campaign.machine);
  const ModelSpec second = parse_model(model_toml(first, "machine.toml"), "again.toml", campaign.machine);
  ASSERT_EQ(second.effects.size(), 1U);
  EXPECT_EQ(first.effects[0].options.all(), second.effects[0].options.all());
}

}  // namespace
}  // namespace volcal
