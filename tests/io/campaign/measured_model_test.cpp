// Where and under what conditions the errors of a model file were measured.

#include <gtest/gtest.h>

#include "tests/support/machines.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"

namespace volcal {
namespace {

TEST(MeasuredModel, SurvivesInModelFiles) {
  ModelSpec model;
  model.measured[AxisName::X] = {0.05, 0.9};
  model.conditions.temperature_degC["front bearing"] = {18.9, 21.4, 24.1};
  model.conditions.time = RecordedRange{0.0, 1800.0, 3600.0};
  model.conditions.feed = RecordedRange{0.5 / 60.0, 1.0 / 60.0, 2.0 / 60.0};
  const ModelSpec again =
      parse_model(model_toml(model, "machine.toml", ""), "again.toml", testing_support::machine_of("wbXYZt"));
  EXPECT_EQ(again.measured, model.measured);
  ASSERT_EQ(again.conditions.temperature_degC.size(), 1);
  const RecordedRange& bearing = again.conditions.temperature_degC.at("front bearing");
  EXPECT_DOUBLE_EQ(bearing.min, 18.9);
  EXPECT_DOUBLE_EQ(bearing.mean, 21.4);
  EXPECT_DOUBLE_EQ(bearing.max, 24.1);
  ASSERT_TRUE(again.conditions.time.has_value());
  EXPECT_DOUBLE_EQ(again.conditions.time->max, 3600.0);
  ASSERT_TRUE(again.conditions.feed.has_value());
  EXPECT_DOUBLE_EQ(again.conditions.feed->min, 0.5 / 60.0);
}

}  // namespace
}  // namespace volcal
