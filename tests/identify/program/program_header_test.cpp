#include "volcal/identify/program/program_header.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/nc_programs.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;

const std::vector<StatedCondition>& some_conditions() {
  static const std::vector<StatedCondition> conditions = {
      {temperature_of("air"), 20.125, "mean of the campaign"},
      {temperature_of("column"), 23.3, "as stated"},
      {{Variable::Kind::Time}, 3600.0, "as stated"}};
  return conditions;
}

TEST(ProgramHeader, StatesWhatItIsMadeOfAndTheConditions) {
  EXPECT_THAT(program_header("result r G54=X0,Y0,Z0", some_conditions()),
              ElementsAre("(volcal compensate: result r G54=X0,Y0,Z0)",
                          "(conditions: T_air_degC=20.125 mean of the campaign, T_column_degC=23.3 as "
                          "stated, time_s=3600 as stated)"));
  EXPECT_THAT(program_header("result r", some_conditions(), CommentStyle::Semicolon),
              ElementsAre("; volcal compensate: result r",
                          "; conditions: T_air_degC=20.125 mean of the campaign, T_column_degC=23.3 as "
                          "stated, time_s=3600 as stated"));
  EXPECT_THAT(program_header("result r", {}), ElementsAre("(volcal compensate: result r)"));
}

TEST(ProgramHeader, EndsNoCommentBeforeItsEnd) {
  EXPECT_THAT(program_header("result a(b)\nG0 X1", {}),
              ElementsAre("(volcal compensate: result a_b__G0 X1)"));
}

TEST(ProgramHeader, IsKnownAgain) {
  for (const CommentStyle style : {CommentStyle::Brackets, CommentStyle::Semicolon}) {
    const std::vector<std::string> header = program_header("result r", some_conditions(), style);
    EXPECT_TRUE(is_compensated("N1 " + header.front() + "\r\n"));
    EXPECT_FALSE(is_compensated(header.back()));
  }
  EXPECT_FALSE(is_compensated("(by volcal compensate: never)"));
}

/// Controls read 255 characters: a header with many tools is as many comments.
TEST(ProgramHeader, IsAsManyCommentsAsItTakes) {
  std::string made_of = "result out/result";
  for (int tool = 1; tool <= 60; ++tool) made_of += " H" + std::to_string(tool) + "=150.125";
  for (const CommentStyle style : {CommentStyle::Brackets, CommentStyle::Semicolon}) {
    const bool brackets = style == CommentStyle::Brackets;
    std::string joined, program;
    const std::vector<std::string> header = program_header(made_of, {}, style);
    EXPECT_GE(header.size(), 3U);
    for (const std::string& line : header) {
      EXPECT_LE(line.size(), kLongestLine);
      ASSERT_TRUE(brackets ? line.starts_with("(") && line.ends_with(")") : line.starts_with("; "));
      joined += (joined.empty() ? "" : " ") + (brackets ? line.substr(1, line.size() - 2) : line.substr(2));
      program += line + "\n";
    }
    EXPECT_EQ(joined, "volcal compensate: " + made_of);
    EXPECT_EQ(testing::motions_of(program + "G21 G90\nG0 X1\n").size(), 1U) << "the comments are read back";
  }
}

}  // namespace
}  // namespace volcal
