// What tools' offsets are wrong by, in model files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/machines.h"
#include "tests/support/refusal.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using testing::refusal;

Machine machine_with_tools() {
  Machine machine = testing_support::machine_of("w X' b Y Z t");
  machine.tools = {{"long", {0.0, 0.0, -0.25}, 0.0}, {"side tool", {0.1, 0.0, -0.2}, 2e-6}};
  return machine;
}

ModelSpec parsed(const std::string& tools) {
  return parse_model("format = \"volcal-model-1\"\n" + tools, "known.toml", machine_with_tools());
}

std::string refused(const std::string& tools) {
  return refusal([&] { parsed(tools); });
}

TEST(ToolErrorsOfModels, AreInMicrometres) {
  const ModelSpec model = parsed("[tools.long]\noffset_error_um = [12, -3.5, 0]\n");
  ASSERT_EQ(model.tool_errors.size(), 1U);
  EXPECT_LT((model.tool_errors.at("long") - Eigen::Vector3d(12e-6, -3.5e-6, 0.0)).norm(), 1e-15);
}

TEST(ToolErrorsOfModels, SurviveInModelFiles) {
  ModelSpec model;
  model.tool_errors["long"] = {1.25e-6, -3e-6, 1e-7};
  model.tool_errors["side tool"] = {0.0, 4e-6, 0.0};
  const std::string text = model_toml(model, "machine.toml");
  EXPECT_THAT(text, HasSubstr("\n[tools.long]\noffset_error_um = [1.25, -3, 0.1]\n"));
  const ModelSpec again = parse_model(text, "again.toml", machine_with_tools());
  ASSERT_EQ(again.tool_errors.size(), 2U);
  for (const auto& [tool, error] : model.tool_errors)
    EXPECT_LT((again.tool_errors.at(tool) - error).norm(), 1e-18) << tool;
}

TEST(ToolErrorsOfModels, AreRefusedWithLineAndRemedy) {
  const std::string unknown = refused("[tools.lang]\noffset_error_um = [1, 2, 3]\n");
  EXPECT_THAT(unknown, HasSubstr("known.toml:2"));
  EXPECT_THAT(unknown, HasSubstr("tools.lang is not a tool of this machine"));
  EXPECT_THAT(unknown, HasSubstr("\"long\""));
  const std::string unit = refused("[tools.long]\noffset_error_mm = [1, 2, 3]\n");
  EXPECT_THAT(unit, HasSubstr("known.toml:3"));
  EXPECT_THAT(unit, HasSubstr("offset_error_um"));
  const std::string twice =
      refused("[tools.long]\noffset_error_um = [1, 2, 3]\n[tools.long]\noffset_error_um = [1, 2, 3]\n");
  EXPECT_THAT(twice, HasSubstr("known.toml:4"));
  const std::string large = refused("[tools.long]\noffset_error_um = [1, 2, -10001]\n");
  EXPECT_THAT(large, HasSubstr("known.toml:3"));
  EXPECT_THAT(large, HasSubstr("beyond 10 mm"));
  EXPECT_THAT(refused("[tools.long]\n"), HasSubstr("offset_error_um is missing"));
  EXPECT_THAT(refused("[tools.long]\noffset_error_um = [1, 2]\n"), HasSubstr("known.toml:3"));
  EXPECT_THAT(refused("[tools.long]\noffset_error_um = [1, 2, 3]\noffset_mm = [0, 0, 1]\n"),
              HasSubstr("known.toml:4"));
}

}  // namespace
}  // namespace volcal
