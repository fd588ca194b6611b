/// Tables of machines with effects that no rigid body has, in a closed loop; docs/studies.md has four
/// structures, six effects and every format.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/long_tests.h"
#include "tests/support/program.h"

namespace volcal {
namespace {

using testing::run_program;

TEST(EffectTablesStudy, TablesTakeTheEffectAwayAsFarAsTheirFormatHoldsIt) {
  const auto run = run_program(
      "study effect-tables -n 1 --case product --case reversal --noise 0.1 --json --format csv --format "
      "neutral-csv --format linuxcnc");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto json = nlohmann::json::parse(run.output);
  ASSERT_EQ(json.at("rows").size(), 6U);
  EXPECT_EQ(json.at("summary").at("above_rigid"), 0) << run.output;
  EXPECT_EQ(json.at("summary").at("above_ideal"), 0) << run.output;
  EXPECT_EQ(json.at("summary").at("printed_otherwise"), 0) << run.output;
  for (const auto& row : json.at("rows")) {
    const double rigid = row.at("rigid_um"), extended = row.at("extended_um"),
                 ideal = row.at("ideal_of_format_um");
    if (row.at("format") == "neutral-csv") {
      EXPECT_LT(extended, 0.2 * rigid) << row;
      EXPECT_LT(ideal, 0.01) << row;
    }
    if (row.at("format") == "csv" && row.at("effect") == "product") {
      EXPECT_GT(ideal, 0.5) << row;
      EXPECT_LT(extended, rigid) << row;
    }
  }
}

TEST(EffectTablesStudy, PrintsARowForEveryFormat) {
  const auto run = run_program("study effect-tables -n 1 --case reversal --format csv --format linuxcnc");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output,
              ::testing::ContainsRegex("format +before .um. +rigid model .um. .* u .um. +printed"));
  EXPECT_THAT(run.output, ::testing::ContainsRegex("csv( +[0-9]+[.][0-9][0-9]){6}"));
  EXPECT_THAT(run.output, ::testing::ContainsRegex("linuxcnc( +[0-9]+[.][0-9][0-9]){6}"));
  EXPECT_THAT(run.output, ::testing::HasSubstr("2 rows: "));
}

TEST(EffectTablesStudy, DoesNotDependOnTheNumberOfThreads) {
  VOLCAL_FOR_THE_NIGHT(
      "CompensationStudy.DoesNotDependOnTheNumberOfThreads, by the same loop over campaigns");
  const std::string study = "study effect-tables -n 2 --case coupled --format linuxcnc --json --threads ";
  const auto one = run_program(study + "1");
  ASSERT_EQ(one.exit_code, 0) << one.errors;
  EXPECT_EQ(one.output, run_program(study + "2").output);
}

}  // namespace
}  // namespace volcal
