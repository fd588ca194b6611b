// Effects whose keys hold lists: in model files and results, and back.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/machines.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/results/result_json_parts.h"

namespace volcal {
namespace {

ModelSpec with_surface(const std::string& keys) {
  return parse_model(
      "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n[[effects]]\nkind = \"empirical\"\n" + keys,
      "model.toml", testing_support::machine_of("wbXYZt"));
}

std::string refusal_of_surface(const std::string& keys) {
  try {
    with_surface(keys);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

const std::string kCurve =
    "target = \"EAY\"\ndrivers = \"T_column\"\nfrom = [18]\nto = [24.5]\npieces = [1]\n"
    "coefficients_urad = [1.5, -0.25, 1e-3, 8]\n";

TEST(EmpiricalModel, ListsAreReadInTheirUnits) {
  const Options options = with_surface(kCurve).effects.front().options;
  EXPECT_EQ(*options.numbers("from"), (std::vector<double>{18.0}));
  EXPECT_EQ(*options.numbers("to"), (std::vector<double>{24.5}));
  const auto coefficients = *options.numbers("coefficients");
  ASSERT_EQ(coefficients.size(), 4u);
  EXPECT_DOUBLE_EQ(coefficients[1], -0.25e-6);
  EXPECT_DOUBLE_EQ(coefficients[3], 8e-6);
}

TEST(EmpiricalModel, SurvivesInModelFilesAndResults) {
  const ModelSpec model = with_surface(kCurve);
  const ModelSpec written =
      parse_model(model_toml(model, "machine.toml", ""), "again.toml", testing_support::machine_of("wbXYZt"));
  const ModelSpec kept = json_parts::model_from(json_parts::model(model));
  for (const ModelSpec* again : {&written, &kept}) {
    ASSERT_EQ(again->effects.size(), 1u);
    EXPECT_EQ(again->effects.front().options.all(), model.effects.front().options.all());
  }
}

TEST(EmpiricalModel, WhatIsNoSurfaceIsRefusedWithItsPlace) {
  using ::testing::AllOf;
  using ::testing::HasSubstr;
  EXPECT_THAT(refusal_of_surface("target = \"EAY\"\ndrivers = \"x\"\nfrom = [1]\n"),
              AllOf(HasSubstr("model.toml:3"), HasSubstr("from and to belong together")));
  EXPECT_THAT(refusal_of_surface("target = \"EAY\"\ndrivers = \"x\"\npieces = 3\n"),
              HasSubstr("model.toml:7"));
  EXPECT_THAT(
      refusal_of_surface("target = \"EAY\"\ndrivers = \"x\"\npieces = [1]\ncoefficients_um = [1,2,3,4]\n"),
      HasSubstr("coefficients_urad"));
  EXPECT_THAT(refusal_of_surface("target = \"EAY\"\n"), HasSubstr("drivers"));
}

}  // namespace
}  // namespace volcal
