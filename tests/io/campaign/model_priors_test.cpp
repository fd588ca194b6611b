// Widths of the priors in a model file, and in what is written from it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/machines.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/results/result_json_parts.h"

namespace volcal {
namespace {

ModelSpec model_with(const std::string& priors) {
  return parse_model("format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n[priors]\n" + priors,
                     "model.toml", testing_support::machine_of("wbXYZt"));
}

std::string problem_of(const std::string& priors) {
  try {
    model_with(priors);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ModelPriors, AreReadInTheirUnits) {
  const PriorWidths priors = model_with("displacement_um = 200\nsquareness_mrad = 5\n").priors;
  EXPECT_DOUBLE_EQ(priors.displacement.value(), 200e-6);
  EXPECT_DOUBLE_EQ(priors.squareness.value(), 5e-3);
  EXPECT_FALSE(priors.rotation.has_value());
}

TEST(ModelPriors, SurviveInModelFilesAndResults) {
  const ModelSpec model = model_with("displacement_um = 200\nrotation_urad = 30\nsquareness_mrad = 5\n");
  const ModelSpec written =
      parse_model(model_toml(model, "machine.toml", ""), "again.toml", testing_support::machine_of("wbXYZt"));
  const ModelSpec kept = json_parts::model_from(json_parts::model(model));
  for (const ModelSpec* again : {&written, &kept}) {
    EXPECT_EQ(again->priors.displacement, model.priors.displacement);
    EXPECT_EQ(again->priors.rotation, model.priors.rotation);
    EXPECT_EQ(again->priors.squareness, model.priors.squareness);
  }
  EXPECT_FALSE(json_parts::model(ModelSpec{}).contains("priors"));
}

TEST(ModelPriors, WhatIsNoWidthIsRefused) {
  EXPECT_THAT(problem_of("squareness_mrad = 0\n"), ::testing::HasSubstr("must be positive"));
  EXPECT_THAT(problem_of("squareness_mrad = -1\n"), ::testing::HasSubstr("model.toml:4"));
  EXPECT_THAT(problem_of("squareness_urad = 5\n"), ::testing::HasSubstr("squareness_mrad"));
}

}  // namespace
}  // namespace volcal
