/// Laser files made from the public description: read as they are, refused with the line when damaged.

#include "volcal/identify/io/import/rtl_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/import_files.h"
#include "tests/support/refusal.h"
#include "volcal/identify/io/import/laser_runs.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::import_machine;
using testing::refusal;
using testing::replaced;
using testing::rtl_answers;
using testing::rtl_text;
using ::testing::SizeIs;
using testing::sorted_rtl_text;

std::string laser_refusal(const std::string& text, const ImportAnswers& answers = rtl_answers()) {
  return refusal([&] {
    const ImportSource source{"x.rtl", text};
    laser_readings(parse_rtl(source), source, answers, import_machine());
  });
}

ImportedReadings laser_import(const std::string& text, const ImportAnswers& answers = rtl_answers()) {
  return laser_readings(parse_rtl({"x.rtl", text}), {"x.rtl", text}, answers, import_machine());
}

const std::vector<double>& laser_column(const ImportedReadings& readings, const std::string& name) {
  static const std::vector<double> kNone;
  for (const ImportedColumn& column : readings.columns) {
    if (column.name == name) return column.values;
  }
  ADD_FAILURE() << "no column " << name;
  return kNone;
}

TEST(RtlFile, SectionsTargetsAndRuns) {
  const LaserFile laser = parse_rtl({"x.rtl", rtl_text()});
  EXPECT_THAT(laser.targets_mm, ElementsAre(0.0, 100.0, 200.0));
  ASSERT_THAT(laser.passes, SizeIs(4));
  EXPECT_TRUE(laser.passes[0].ascending);
  EXPECT_FALSE(laser.passes[1].ascending);
  EXPECT_EQ(laser.passes[1].readings[0].target, 3);
  EXPECT_EQ(laser.passes[1].readings[2].value, -3.0);
  EXPECT_EQ(laser.passes[1].readings[2].line, 32);
  EXPECT_EQ(laser.find({"axis"})->value, "X");
  EXPECT_EQ(laser.find({"date"})->value, "2024-05-06 10:20:30");
  EXPECT_EQ(laser.find({"air temp"})->section, "ENVIRONMENT");
  EXPECT_EQ(laser.find({"mat temp 3"}), nullptr);
  EXPECT_FALSE(laser.decimal_comma);
}

TEST(RtlFile, ReadingsInTheOrderInWhichTheyWereTaken) {
  for (const bool sorted : {false, true}) {
    ImportAnswers answers = rtl_answers();
    if (sorted) answers.runs = "alternating";
    const ImportedReadings readings = laser_import(sorted ? sorted_rtl_text() : rtl_text(), answers);
    EXPECT_THAT(laser_column(readings, "x_mm"),
                ElementsAre(0, 100, 200, 200, 100, 0, 0, 100, 200, 200, 100, 0));
    EXPECT_THAT(laser_column(readings, "dir_x"), ElementsAre(1, 1, 1, -1, -1, -1, 1, 1, 1, -1, -1, -1));
    EXPECT_THAT(laser_column(readings, "deviation_um"), ElementsAre(0, 2, 4, 1, -1, -3, 2, 4, 6, 3, 1, -1));
    EXPECT_THAT(laser_column(readings, "line"), ElementsAre(1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4));
    EXPECT_EQ(laser_column(readings, "y_mm")[7], 250.0);
    EXPECT_EQ(laser_column(readings, "T_air_degC")[0], 21.5);
    EXPECT_EQ(laser_column(readings, "T_material_1_degC")[11], 20.8);
    EXPECT_EQ(readings.keys.at("direction"), "[1.0, 0.0, 0.0]");
    EXPECT_FALSE(readings.guessed);
    EXPECT_EQ(readings.source_line[3], sorted ? 32 : 30) << "reading of target 3 in run 2";
  }
}

TEST(RtlFile, UnitsOfDeviations) {
  const auto second = [](const char* unit) {
    ImportAnswers answers = rtl_answers();
    answers.unit = unit;
    return laser_column(laser_import(rtl_text(), answers), "deviation_um")[1];
  };
  EXPECT_NEAR(second("um"), 2.0, 1e-12);
  EXPECT_NEAR(second("mm"), 2000.0, 1e-9);
  EXPECT_NEAR(second("nm"), 0.002, 1e-15);
  ImportAnswers angle = rtl_answers();
  angle.unit = "arcsec";
  angle.measures = "ECX";
  const ImportedReadings yaw = laser_import(replaced(rtl_text(), ": Linear", ": Angular"), angle);
  EXPECT_NEAR(laser_column(yaw, "angle_urad")[1], 2.0 * 4.84813681109536, 1e-9);
  EXPECT_EQ(yaw.keys.at("axis"), "[0.0, 0.0, 1.0]");
}

/// From 200 mm down to 0 the axis moves in its - direction first.
TEST(RtlFile, FallingTargets) {
  const std::string text =
      replaced(replaced(rtl_text(), "0.000  100", "200.000  100"), "\n 200.000", "\n 0.000");
  const ImportedReadings readings = laser_import(text);
  EXPECT_THAT(laser_column(readings, "dir_x"), ElementsAre(-1, -1, -1, 1, 1, 1, -1, -1, -1, 1, 1, 1));
  EXPECT_EQ(laser_column(readings, "x_mm")[0], 200.0);
}

TEST(RtlFile, TargetsAreShiftedByThePositionOfTheAxis) {
  ImportAnswers answers = rtl_answers();
  answers.at[AxisName::X] = 50.0;
  EXPECT_EQ(laser_column(laser_import(rtl_text(), answers), "x_mm")[2], 250.0);
}

/// The last target is 200,000: 200 mm, or two hundred metres.
TEST(RtlFile, AnOpenDecimalSignIsAskedFor) {
  const std::string runs = "RUNS::\nRun-count: 1\nDEVIATIONS::\nRun Target Data:\n1 1 2\n1 2 3\n1 3 -3\n";
  const std::string text = replaced(replaced(std::string(testing::kRtlHead), "0.000  100.000", "0  100,000"),
                                    "200.000", "200,000") +
                           runs;
  EXPECT_THAT(refusal([&] {
                parse_rtl({"x.rtl", text});
              }),
              HasSubstr("give --decimal comma or --decimal point"));
  EXPECT_THAT(parse_rtl({"x.rtl", text, ','}).targets_mm, ElementsAre(0.0, 100.0, 200.0));
  EXPECT_TRUE(parse_rtl({"x.rtl", text, ','}).decimal_comma);
  EXPECT_THAT(parse_rtl({"x.rtl", text, '.'}).targets_mm, ElementsAre(0.0, 1e5, 2e5));
  EXPECT_THAT(parse_rtl({"x.rtl", replaced(text, "1 2 3", "1 2 0,5")}).targets_mm,
              ElementsAre(0.0, 100.0, 200.0));
  EXPECT_THAT(refusal([&] {
                parse_rtl({"x.rtl", replaced(text, "1 2 3", "1 2 0.5")});
              }),
              HasSubstr("decimal commas and decimal points stand in one file"));
}

TEST(RtlFile, WhatTheFileDoesNotSayIsAskedFor) {
  ImportAnswers none;
  EXPECT_THAT(laser_refusal(rtl_text(), none), HasSubstr("unit of the deviations (give --unit um"));
  ImportAnswers answers = rtl_answers();
  answers.at.clear();
  EXPECT_THAT(laser_refusal(rtl_text(), answers), HasSubstr("--at Y=...,Z=..."));
  EXPECT_THAT(laser_refusal(sorted_rtl_text()), HasSubstr("--runs forward, backward or alternating"));
  EXPECT_THAT(laser_refusal(replaced(rtl_text(), "Axis: X", "Axis:")), HasSubstr("give --axis X"));
  EXPECT_THAT(laser_refusal(replaced(rtl_text(), "Axis: X", "Axis: X and Y")), HasSubstr("give --axis X"));
  EXPECT_THAT(laser_refusal(replaced(replaced(rtl_text(), ": Linear", ": ?"), ": rtl", ": ?")),
              HasSubstr("--measures EXX"));
  EXPECT_THAT(laser_refusal(replaced(rtl_text(), ": Linear", ": Angular")), HasSubstr("--measures E?X"));
}

TEST(RtlFile, AnswersAgainstTheFileAreRefused) {
  ImportAnswers answers = rtl_answers();
  answers.runs = "forward";
  EXPECT_THAT(
      laser_refusal(rtl_text(), answers),
      HasSubstr("x.rtl:30: run 2 lists its targets from the last to the first, against --runs forward"));
  answers = rtl_answers();
  answers.measures = "ECX";
  EXPECT_THAT(laser_refusal(rtl_text(), answers),
              HasSubstr("of the kind angular; by line 3 the file is of the kind linear"));
  answers = rtl_answers();
  answers.axis = "B";
  EXPECT_THAT(laser_refusal(rtl_text(), answers), HasSubstr("axis B is rotary"));
  answers = rtl_answers();
  answers.unit = "furlong";
  EXPECT_THAT(laser_refusal(rtl_text(), answers), HasSubstr("--unit furlong"));
}

TEST(RtlFile, DamagedFilesAreRefusedWithTheLine) {
  const auto damaged = [](const std::string& from, const std::string& to) {
    EXPECT_NE(rtl_text().find(from), std::string::npos) << from;
    return laser_refusal(replaced(rtl_text(), from, to));
  };
  EXPECT_THAT(damaged("2   2      -1.0\n", ""),
              HasSubstr("x.rtl:31: target 1 stands where target 2 of run 2"));
  EXPECT_THAT(damaged("2   2      -1.0", "2   2      -1.o"),
              HasSubstr("x.rtl:31: \"2   2      -1.o\" in DEVIATIONS is not understood"));
  EXPECT_THAT(damaged("2   2      -1.0", "2   2"), HasSubstr("x.rtl:31:"));
  EXPECT_THAT(damaged("2   2      -1.0", "2   2   -1.0  7"), HasSubstr("x.rtl:31:"));
  EXPECT_THAT(damaged("2   2      -1.0", "2   2   nan"), HasSubstr("x.rtl:31:"));
  EXPECT_THAT(damaged("2   2      -1.0", "2   7      -1.0"),
              HasSubstr("x.rtl:31: target 7 stands where target 2"));
  EXPECT_THAT(damaged("2   2      -1.0", "9   2      -1.0"),
              HasSubstr("x.rtl:30: run 2 ends after 1 of 3 targets"));
  EXPECT_THAT(damaged("4   1      -1.0\n", ""), HasSubstr("x.rtl:37: run 4 ends after 2 of 3 targets"));
  EXPECT_THAT(damaged("Run-count: 4", "Run-count: 5"),
              HasSubstr("x.rtl:23: Run-count is 5, but DEVIATIONS holds 4 runs"));
  EXPECT_THAT(damaged("Run-count: 4", "Run-count: four"), HasSubstr("x.rtl:23: the count \"four\""));
  EXPECT_THAT(damaged("Target-count: 3", "Target-count: 4"),
              HasSubstr("x.rtl:8: Target-count is 4, but 3 targets follow"));
  EXPECT_THAT(damaged(" 200.000 \n", " 50.000 \n"), HasSubstr("x.rtl:9: target 3, 50 mm, does not continue"));
  EXPECT_THAT(damaged(" 200.000 \n", " 2OO.000 \n"),
              HasSubstr("x.rtl:11: the target \"2OO.000\" is not a number"));
  EXPECT_THAT(damaged("EOF::\n", "EOF::\nHEADER::\n"), HasSubstr("text behind EOF::"));
  EXPECT_THAT(damaged("Air temp   : 21.50", "Air temp   : warm"),
              HasSubstr("x.rtl:41: the temperature \"warm\""));
  EXPECT_THAT(damaged("HEADER::\n", "rubbish\n"),
              HasSubstr("x.rtl:1: the file does not begin with a section"));
  const std::string text = rtl_text();
  EXPECT_THAT(laser_refusal(text.substr(0, text.find("DEVIATIONS"))),
              HasSubstr("the file has no deviations"));
}

}  // namespace
}  // namespace volcal
