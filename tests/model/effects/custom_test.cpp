// Effects that users write: what an expression means, and what is said of one that cannot be used.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/support/effect_campaign.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/effects/expression.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/observation/measurement_model.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using testing_support::effect_campaign;

EffectSpec custom(const std::string& target, const std::string& expression) {
  EffectSpec spec;
  spec.kind = "custom";
  spec.source_line = 7;
  spec.options.set("target", target);
  spec.options.set("expression", expression);
  return spec;
}

std::unique_ptr<Effect> made(const EffectSpec& spec) {
  return find_effect("custom")->make(spec, "model.toml");
}

class Custom : public ::testing::Test {
 protected:
  Custom() {
    model_.default_function.basis = "zero";
    const MeasurementModel model(campaign_, model_);
    views_ = setup_views(campaign_, model.binding(), model.chain());
  }

  const SetupView& view(const std::string& setup) const {
    for (const SetupView& each : views_) {
      if (each.setup.name == setup) return each;
    }
    throw std::out_of_range(setup);
  }

  /// Driver of one reading.
  double driver(const EffectSpec& spec, const std::string& setup, Eigen::Index row) const {
    const auto effect = made(spec);
    return effect->drivers(view(setup), effect->shape_values())(row, 0);
  }

  /// What make, check and drivers say of an effect.
  std::string refusal(const EffectSpec& spec) const {
    try {
      const auto effect = made(spec);
      effect->check(campaign_, {"model.toml", 7});
      for (const SetupView& each : views_) effect->drivers(each, effect->shape_values());
    } catch (const InputError& error) {
      EXPECT_EQ(error.place().file, "model.toml");
      EXPECT_EQ(error.place().line, 7);
      EXPECT_FALSE(error.remedy().empty());
      return error.what();
    }
    return "accepted";
  }

  Campaign campaign_ = effect_campaign("w X' b Y Z C t");
  ModelSpec model_;
  std::vector<SetupView> views_;
};

/// Positions in mm and deg as commanded, directions, s since the first reading, degC, mm/min, mm.
TEST_F(Custom, VariablesHaveTheUnitsThatUsersWrite) {
  const Readings& readings = view("S2").setup.readings;
  const auto value = [&](const std::string& expression) {
    return driver(custom("EAY", expression), "S2", 5);
  };
  EXPECT_NEAR(value("x"), 1000.0 * readings.position[0][5], 1e-10);
  EXPECT_NEAR(value("c"), readings.position[5][5] * 180.0 / std::numbers::pi, 1e-10);
  EXPECT_EQ(value("dir_z"), readings.direction[2][5]);
  EXPECT_NEAR(value("t"), 1000.0 + 5.0 * 20.0, 1e-10);
  EXPECT_EQ(value("T_spindle"), 21.0);
  EXPECT_NEAR(value("feed"), 0.01 * 60000.0, 1e-9);
  EXPECT_NEAR(value("tool_x + 10 * tool_z"), 150.0 - 2000.0, 1e-10);
  EXPECT_NEAR(value("tool_length"), std::sqrt(150.0 * 150.0 + 50.0 * 50.0 + 200.0 * 200.0), 1e-10);
  const double length = (view("S2").nominal_point_w[5] - Eigen::Vector3d(-0.4, 0.9, -0.2)).norm();
  EXPECT_NEAR(value("length"), 1000.0 * length, 1e-9);
}

TEST_F(Custom, ExpressionsAreReadAsWritten) {
  const double z = 1000.0 * view("S1").setup.readings.position[2][3];
  const auto value = [&](const std::string& expression) {
    return driver(custom("EAY", expression), "S1", 3);
  };
  EXPECT_NEAR(value("2 + 3 * z ^ 2"), 2.0 + 3.0 * z * z, 1e-9 * z * z);
  EXPECT_NEAR(value("z > 0 ? sin(2 * pi * z / 40) : -1"), std::sin(2.0 * std::numbers::pi * z / 40.0), 1e-12);
  EXPECT_NEAR(value("max(z, 1e3) + 1.5E-1"), std::max(z, 1000.0) + 0.15, 1e-12);
  EXPECT_NEAR(value("1-exp(-z/250)"), 1.0 - std::exp(-z / 250.0), 1e-12);
}

TEST_F(Custom, TargetsAndTheirUnits) {
  const auto amplitude = [](const char* target) { return made(custom(target, "x"))->amplitudes()[0]; };
  EXPECT_EQ(amplitude("EAY").target.symbol, (ErrorSymbol{Component::A, AxisName::Y}));
  EXPECT_EQ(amplitude("EAY").unit(), "urad");
  EXPECT_EQ(amplitude("EXY").unit(), "um");
  EXPECT_EQ(amplitude("tool y").target.kind, TargetKind::ToolOffset);
  EXPECT_EQ(amplitude("tool side y").target.component, 1);
  EXPECT_EQ(amplitude("station P1 z").target.kind, TargetKind::Station);
  EXPECT_EQ(amplitude("length_mm").target.component, 0);
  EXPECT_EQ(amplitude("length_mm").unit(), "um");
  EXPECT_EQ(amplitude("elevation_deg of K1").target.component, 2);
  EXPECT_EQ(amplitude("elevation_deg").unit(), "urad");
  EXPECT_EQ(amplitude("angle_urad").unit(), "urad");
}

/// Nothing where the target is another's, or a variable was not recorded.
TEST_F(Custom, ActsWhereItsTargetIsAndItsVariablesAre) {
  EXPECT_NE(driver(custom("tool side y", "x"), "S2", 1), 0.0);
  EXPECT_EQ(driver(custom("tool side y", "x"), "S1", 1), 0.0);
  EXPECT_NE(driver(custom("station P1 x", "x"), "S3", 1), 0.0);
  EXPECT_EQ(driver(custom("station P1 x", "x"), "S2", 1), 0.0);
  EXPECT_NE(driver(custom("length_mm", "x"), "B1", 1), 0.0);
  EXPECT_EQ(driver(custom("length_mm", "x"), "D1", 1), 0.0);
  EXPECT_EQ(driver(custom("length_mm of S1", "x"), "S2", 1), 0.0);
  EXPECT_EQ(driver(custom("azimuth_deg of K1", "x"), "S1", 1), 0.0);
  campaign_.setups[1].readings.temperature.erase("spindle");
  const auto effect = made(custom("EAY", "T_spindle"));
  EXPECT_EQ(effect->drivers(view("S2"), {}), Eigen::VectorXd::Zero(testing_support::kEffectRows));
  EXPECT_EQ(effect->unrecorded(view("S2")), testing_support::kEffectRows);
  EXPECT_EQ(effect->unrecorded(view("S1")), 0U);
}

TEST_F(Custom, ParametersOfTheShapeCanBeHeldOrEstimated) {
  EffectSpec spec = custom("tool z", "1 - exp(-t / p) + 0 * q");
  spec.options.set("p", 600.0);
  spec.options.set("p_sigma", 100.0);
  spec.options.set("q", 1.0);
  const auto effect = made(spec);
  ASSERT_EQ(effect->shapes().size(), 2U);
  EXPECT_EQ(effect->shapes()[0].value, 600.0);
  EXPECT_EQ(effect->shapes()[0].sigma, 100.0);
  EXPECT_EQ(effect->shapes()[1].sigma, 0.0);
  EXPECT_NEAR(effect->drivers(view("S2"), Eigen::Vector2d(600.0, 1.0))(0, 0), 1.0 - std::exp(-1000.0 / 600.0),
              1e-12);
  EXPECT_EQ(effect->name().driver.name(), "t");
}

/// A value that is estimated moves with the fit, and its effect stays the same one.
TEST_F(Custom, AHeldValueIsPartOfItsName) {
  EffectSpec spec = custom("tool z", "sin(t / p)");
  spec.options.set("p", 30.0);
  EXPECT_EQ(made(spec)->name().shape, "sin(t / p) with p=30");
  EXPECT_EQ(made(spec)->amplitudes()[0].label, "tool z by sin(t / p) with p=30");
  spec.options.set("p_sigma", 5.0);
  EXPECT_EQ(made(spec)->name().shape, "sin(t / p)");
}

TEST_F(Custom, IsNeverLookedFor) { EXPECT_TRUE(find_effect("custom")->candidates(campaign_).empty()); }

/// 10 urad per metre of z on EAY, seen by a level on the tool about x: 10 urad times z.
TEST_F(Custom, ActsInThePrediction) {
  campaign_.setups.back().options.set("axis", Eigen::Vector3d(1.0, 0.0, 0.0));
  campaign_.setups.back().options.set("body", std::string("tool"));
  EffectSpec spec = custom("EAY", "z / 1000");
  spec.options.set("amplitude", 10e-6);
  model_.effects = {spec};
  const MeasurementModel model(campaign_, model_);
  const Eigen::VectorXd with = model.initial_parameters();
  Eigen::VectorXd without = with;
  without[model.binding().effects[0].first_parameter] = 0.0;
  const std::size_t level = campaign_.setups.size() - 1;
  double high = 0.0, low = 0.0;
  model.predict(level, 4, with, &high);
  model.predict(level, 4, without, &low);
  EXPECT_NEAR(high - low, 10e-6 * campaign_.setups[level].readings.position[2][4], 1e-15);
}

TEST_F(Custom, SaysWhatIsWrongWithAnExpression) {
  const auto said = [&](const std::string& expression) { return refusal(custom("EAY", expression)); };
  EXPECT_THAT(said("z * zz"), HasSubstr("a variable of this name is not known, at character 5, \"zz\""));
  EXPECT_THAT(said("z * zz"), HasSubstr("variables are x y z a b c"));
  EXPECT_THAT(said("z * sinus(x)"),
              HasSubstr("a function of this name is not known, at character 5, \"sinus\""));
  EXPECT_THAT(said("z * sinus(x)"), HasSubstr("functions are"));
  EXPECT_THAT(said("z * * x"), HasSubstr("an operator stands where a value is expected, at character 5"));
  EXPECT_THAT(said("z x"), HasSubstr("an operator is missing"));
  EXPECT_THAT(said("(z + 1"), HasSubstr("parentheses do not match"));
  EXPECT_THAT(said("z +"), HasSubstr("it ends where a value is expected"));
  EXPECT_THAT(said("sin(z, x)"), HasSubstr("too many arguments"));
  EXPECT_THAT(said("z, x"), HasSubstr("a comma stands outside of a function"));
  EXPECT_THAT(said("z = 3"), HasSubstr("a comparison is written =="));
  EXPECT_THAT(said("z # x"), HasSubstr("expression \"z # x\""));
  EXPECT_THAT(said("\"z\""), HasSubstr("cannot be read"));
  EXPECT_THAT(said("3 + 4"), HasSubstr("depends on nothing"));
  EXPECT_THAT(said(""), HasSubstr("names no expression"));
}

TEST_F(Custom, SaysWhatIsNotFiniteAndWhere) {
  const std::string said = refusal(custom("EAY", "sqrt(x - 300)"));
  EXPECT_THAT(said, HasSubstr("is not finite at setup S1, line "));
  EXPECT_THAT(said, HasSubstr("x = "));
  EXPECT_THAT(refusal(custom("EAY", "1 / (dir_x - dir_x)")), HasSubstr("is not finite"));
}

TEST_F(Custom, SaysWhichColumnIsMissing) {
  EXPECT_THAT(refusal(custom("EAY", "T_oil")), HasSubstr("column T_oil_degC is missing"));
  EXPECT_THAT(refusal(custom("EAY", "T_oil")), HasSubstr("air, spindle"));
  EXPECT_THAT(refusal(custom("EAY", "a")), HasSubstr("the machine has no axis A"));
  for (volcal::Setup& setup : campaign_.setups) {
    setup.readings.feed.clear();
    setup.readings.direction[1].clear();
    setup.readings.time.clear();
  }
  EXPECT_THAT(refusal(custom("EAY", "feed")), HasSubstr("column feed_mm_min is missing"));
  EXPECT_THAT(refusal(custom("EAY", "dir_y")), HasSubstr("column dir_y is missing"));
  EXPECT_THAT(refusal(custom("EAY", "t")), HasSubstr("column time_s is missing"));
}

TEST_F(Custom, SaysWhatIsWrongWithATarget) {
  const auto said = [&](const std::string& target) { return refusal(custom(target, "x")); };
  for (const char* wrong :
       {"EXQ", "tool", "tool w", "station x", "station P1", "reading", "length", "floor x"}) {
    EXPECT_THAT(said(wrong), HasSubstr("is not a target")) << wrong;
  }
  EXPECT_THAT(said("EXA"), HasSubstr("the machine has no axis A"));
  EXPECT_THAT(said("tool long x"), HasSubstr("no setup uses a tool \"long\""));
  EXPECT_THAT(said("station P9 x"), HasSubstr("no setup stands at a station \"P9\""));
  EXPECT_THAT(said("length_mm of S9"), HasSubstr("the campaign has no setup \"S9\""));
  EXPECT_THAT(said("azimuth_deg of S1"), HasSubstr("no reading has the column azimuth_deg"));
}

TEST_F(Custom, SaysWhichParameterIsMissingOrUnused) {
  EXPECT_THAT(refusal(custom("EAY", "z * p")), HasSubstr("uses p, which has no value"));
  EffectSpec unused = custom("EAY", "z");
  unused.options.set("q", 1.0);
  EXPECT_THAT(refusal(unused), HasSubstr("does not use q"));
}

/// X goes to 20 mm in steps of 10 and turns: back by 5 mm, by 10, then by 1 mm from reading to reading.
TEST_F(Custom, TheTravelSinceTurningCountsFromTheReadingBefore) {
  volcal::Readings& readings = campaign_.setups[0].readings;
  const std::vector<double> first = {0.0, 10.0, 20.0, 15.0, 5.0};
  for (std::size_t row = 0; row < readings.size(); ++row) {
    const double x_mm = row < first.size() ? first[row] : 5.0 - static_cast<double>(row - 4);
    readings.position[index_of(AxisName::X)][row] = 1e-3 * x_mm;
    readings.direction[index_of(AxisName::X)][row] = row < 3 ? 1 : -1;
  }
  const EffectSpec since = custom("EXX", "since_x");
  EXPECT_NEAR(driver(since, "S1", 3), 5.0, 1e-9);
  EXPECT_NEAR(driver(since, "S1", 4), 15.0, 1e-9);
  EXPECT_NEAR(driver(since, "S1", 23), 34.0, 1e-9);
  EXPECT_NEAR(driver(since, "S1", 1), 34.0, 1e-9) << "as far as ever until it first turns";
  EXPECT_THAT(refusal(custom("EXX", "since_q")), HasSubstr("since_x"));
}

/// Names of channels that are no names of variables.
TEST_F(Custom, AChannelIsWrittenWithUnderscores) {
  for (volcal::Setup& setup : campaign_.setups) {
    setup.readings.temperature["Air-top 2"] = setup.readings.temperature["air"];
  }
  EXPECT_NEAR(driver(custom("EAY", "T_Air_top_2 - 20"), "S1", 2),
              view("S1").setup.readings.temperature.at("air")[2] - 20.0, 1e-12);
}

TEST_F(Custom, AChannelMayHaveLettersOutsideAscii) {
  for (volcal::Setup& setup : campaign_.setups) {
    setup.readings.temperature["Öl"] = setup.readings.temperature["air"];
  }
  EXPECT_NEAR(driver(custom("EAY", "2 * T_Öl - 20"), "S1", 2),
              2.0 * view("S1").setup.readings.temperature.at("air")[2] - 20.0, 1e-12);
}

}  // namespace
}  // namespace volcal
