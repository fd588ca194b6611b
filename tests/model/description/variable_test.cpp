#include "volcal/model/description/variable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace volcal {
namespace {

using Kind = Variable::Kind;
using ::testing::ElementsAre;

/// A variable with its name in results, in expressions (empty: not there), its column and its unit.
struct ExpectedVariable {
  Variable variable;
  std::string name, written, column, unit;
};

const std::vector<ExpectedVariable>& expected_variables() {
  static const std::vector<ExpectedVariable> kVariables = {
      {position_of(AxisName::Y), "y", "y", "y_mm", "mm"},
      {position_of(AxisName::C), "c", "c", "c_deg", "deg"},
      {position_of(AxisName::W), "w", "w", "w_mm", "mm"},
      {direction_of_approach(AxisName::A), "dir_a", "dir_a", "dir_a", ""},
      {{Kind::Speed, AxisName::X}, "speed_x", "", "speed_x", ""},
      {{Kind::Time}, "time", "t", "time_s", "s"},
      {temperature_of("column_2"), "T_column_2", "T_column_2", "T_column_2_degC", "degC"},
      {{Kind::Length}, "length", "length", "length", "mm"},
      {{Kind::Elevation}, "elevation", "", "elevation", "deg"},
      {{Kind::Run}, "run", "", "run", ""},
      {{Kind::Feed}, "feed", "feed", "feed_mm_min", "mm_min"},
      {{.kind = Kind::Instrument, .subject = "ball-bar"},
       "instrument ball-bar",
       "",
       "instrument ball-bar",
       ""},
      {{.kind = Kind::Tool, .subject = "side x"}, "tool side x", "", "tool side x", ""},
      {{.kind = Kind::Station, .subject = "P1"}, "station P1", "", "station P1", ""},
      {{Kind::TravelSinceTurning, AxisName::Z}, "travel since dir_z", "since_z", "since_z", "mm"},
      {{Kind::TravelSinceTurning, AxisName::B}, "travel since dir_b", "since_b", "since_b", "deg"},
      {{Kind::ToolLength}, "tool_length", "tool_length", "tool_length", "mm"},
      {{.kind = Kind::ToolOffset, .component = 2}, "tool_z", "tool_z", "tool_z", "mm"},
  };
  return kVariables;
}

TEST(Variable, NamesAreReadAgain) {
  for (const ExpectedVariable& each : expected_variables()) {
    EXPECT_EQ(each.variable.name(), each.name);
    EXPECT_EQ(Variable::parse(each.name), each.variable) << each.name;
    EXPECT_EQ(each.variable.unit().suffix, each.unit) << each.name;
  }
  for (const char* text : {"nonsense", "X", "dir_X", "dir_", "T_", "tool ", "times", "since_q", "tool_w", ""})
    EXPECT_EQ(Variable::parse(text), std::nullopt) << text;
}

TEST(Variable, ExpressionsHaveTheWordsOfUsers) {
  for (const ExpectedVariable& each : expected_variables()) {
    if (each.written.empty()) {
      EXPECT_EQ(Variable::parse_written(each.name), std::nullopt) << each.name;
      continue;
    }
    EXPECT_EQ(each.variable.written(), each.written);
    EXPECT_EQ(Variable::parse_written(each.written), each.variable) << each.written;
  }
  EXPECT_EQ(Variable::parse_written("time"), std::nullopt) << "an expression says t";
  EXPECT_EQ(Variable::parse_written("travel since dir_x"), std::nullopt);
}

TEST(Variable, ColumnsAreThoseOfReadingsFiles) {
  for (const ExpectedVariable& each : expected_variables()) {
    EXPECT_EQ(each.variable.column(), each.column);
    EXPECT_EQ(Variable::parse_column(each.column), each.variable) << each.column;
  }
  for (const char* column : {"x", "x_deg", "T_air", "T_degC", "time", "time_ms", "feed", "length_mm", "x_um"})
    EXPECT_EQ(Variable::parse_column(column), std::nullopt) << column;
}

TEST(Variable, AChannelWithABlankIsWrittenWithout) {
  const Variable bearing = temperature_of("front bearing");
  EXPECT_EQ(bearing.name(), "T_front bearing");
  EXPECT_EQ(bearing.written(), "T_front_bearing");
  EXPECT_EQ(bearing.column(), "T_front bearing_degC");
  EXPECT_EQ(Variable::parse_column("T_front bearing_degC"), bearing);
  EXPECT_EQ(temperature_or_time("front bearing"), bearing);
  EXPECT_EQ(temperature_or_time("").kind, Kind::Time);
}

TEST(Variable, ListsAreReadAgain) {
  const std::vector<Variable> variables = variables_in(" y  T_column dir_x t ");
  EXPECT_THAT(names_of(variables), ElementsAre("y", "T_column", "dir_x", "time"));
  EXPECT_THAT(written_names(variables), ElementsAre("y", "T_column", "dir_x", "t"));
  EXPECT_EQ(written_list(variables), "y T_column dir_x t");
  EXPECT_THAT(variables_in(""), ::testing::IsEmpty());
  EXPECT_THROW(variables_in("y nonsense"), std::invalid_argument);
}

}  // namespace
}  // namespace volcal
