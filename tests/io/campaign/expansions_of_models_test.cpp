// Identified expansions of scales in model files and results.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/machines.h"
#include "tests/support/refusal.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/results/result_json_parts.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using testing::refusal;

Machine machine_with_scale() {
  Machine machine = testing_support::machine_of("w X' b Y Z t");
  machine.axes[0].expansion = ScaleExpansion{14e-6, 3e-6, "column"};
  return machine;
}

ModelSpec read_expansions(const std::string& axes) {
  return parse_model("format = \"volcal-model-1\"\n" + axes, "known.toml", machine_with_scale());
}

std::string refused_expansions(const std::string& axes) {
  return refusal([&] { read_expansions(axes); });
}

TEST(ExpansionsOfModels, AreInMicrometresPerMetreAndKelvin) {
  const ModelSpec model = read_expansions("[axes.X]\nexpansion_um_per_m_K = 10.05\n");
  ASSERT_EQ(model.expansions.size(), 1U);
  EXPECT_DOUBLE_EQ(model.expansions.at(AxisName::X), 10.05e-6);
}

TEST(ExpansionsOfModels, AreWrittenAndReadAgain) {
  ModelSpec model;
  model.expansions[AxisName::X] = 10.05e-6;
  const std::string text = model_toml(model, "machine.toml", "");
  EXPECT_THAT(text, HasSubstr("\n[axes.X]\nexpansion_um_per_m_K = 10.05\n"));
  EXPECT_DOUBLE_EQ(parse_model(text, "again.toml", machine_with_scale()).expansions.at(AxisName::X),
                   10.05e-6);
  EXPECT_EQ(json_parts::model_from(json_parts::model(model)).expansions, model.expansions);
}

TEST(ExpansionsOfModels, ThatMakeNoSenseAreRefused) {
  const std::string unknown = refused_expansions("[axes.V]\nexpansion_um_per_m_K = 10\n");
  EXPECT_THAT(unknown, HasSubstr("known.toml:2"));
  EXPECT_THAT(unknown, HasSubstr("axes.V is not an axis of this machine"));
  const std::string without = refused_expansions("[axes.Y]\nexpansion_um_per_m_K = 10\n");
  EXPECT_THAT(without, HasSubstr("known.toml:3"));
  EXPECT_THAT(without, HasSubstr("the machine file has no temperature of this scale"));
  EXPECT_THAT(refused_expansions("[axes.X]\nexpansion_um_per_m_K = 1000\n"), HasSubstr("known.toml:3"));
  EXPECT_THAT(refused_expansions("[axes.X]\n"), HasSubstr("expansion_um_per_m_K is missing"));
  EXPECT_THAT(refused_expansions("[axes.X]\nexpansion_um_per_m_K = 10\ntemperature = \"column\"\n"),
              HasSubstr("temperature"));
}

}  // namespace
}  // namespace volcal
