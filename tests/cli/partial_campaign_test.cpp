/// What the program says of campaigns that cannot see every error: exit code, text, JSON, tables.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/simulated_campaign.h"

namespace volcal {
namespace {

using ::testing::ContainsRegex;
using testing::content;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_program;

const std::string kCirclesAndDiagonals = R"(
[[measurements]]
kind = "ball-bar-circles"
tool = "short"
points_per_turn = 60
noise = { constant_um = 0.3, repeatability_um = 0.5 }
[[measurements]]
kind = "diagonals"
diagonals = "body"
tool = "short"
points = 21
noise = { constant_um = 0.25, per_metre_um = 0.3, repeatability_um = 0.5 }
)";

const std::string kOneTracerSetup = R"(
[[measurements]]
kind = "laser-tracer"
grid = [6, 5, 4]
noise = { constant_um = 0.25, per_metre_um = 0.3, repeatability_um = 0.6 }
stations = [{ name = "P1", position_mm = [-700.0, -500.0, -600.0] }]
runs = [{ station = "P1", tool = "short" }]
)";

class PartialCampaignProgram : public ::testing::TestWithParam<std::pair<std::string, std::string>> {
 protected:
  std::string path(const std::string& name) const { return simulated_.path(name); }

  /// The demo's machine with reference points at the origin: no tilt has a lever arm but the tool.
  void write_machine() const {
    std::ifstream demo(testing::kDemoMachine);
    std::ofstream machine(path("machine.toml"));
    for (std::string line; std::getline(demo, line);) {
      if (!line.starts_with("reference_point_mm")) machine << line << "\n";
    }
  }

  void simulate(const std::string& measurements) {
    write_machine();
    simulated_.simulate(5, measurements, 3, 1, "machine.toml");
  }
  auto fit(const std::string& options = "") const { return simulated_.fit(options); }

 private:
  ::volcal::testing::SimulatedCampaign simulated_;
};

TEST_P(PartialCampaignProgram, SaysInWordsWhatIsNotSeenAndGivesTheRest) {
  simulate(GetParam().second);
  const auto run = fit("--verbose");
  ASSERT_EQ(run.exit_code, 1) << run.errors;
  const std::string& text = run.output;
  EXPECT_THAT(text, HasSubstr("status rank_deficient"));
  EXPECT_THAT(text,
              HasSubstr("! ECZ: not visible, every tool offset lies on Z; add setups with a tool offset "
                        "sideways to Z (100 mm or more)"));
  EXPECT_THAT(text, ContainsRegex("! EBZ: not visible, a change of it can be exchanged with .*EXZ"));
  EXPECT_THAT(text, ContainsRegex("Rank: the readings alone determine [0-9]+ of [0-9]+ parameters; [0-9]+ "
                                  "combinations are not determined"));
  EXPECT_THAT(text, ContainsRegex("EBZ +urad +- +- .*NOT VISIBLE"));
  EXPECT_THAT(text, ContainsRegex("EZZ +um +-?[0-9.]+ +-?[0-9.]+ "));
  EXPECT_THAT(text, Not(ContainsRegex("EZZ [^\n]*NOT VISIBLE")));
  EXPECT_THAT(content(path("result/error_tables.csv")), ContainsRegex("EZZ,Z,-450,mm,0,-?[0-9.]+,um,"));
}

TEST_P(PartialCampaignProgram, SaysTheSameInJson) {
  simulate(GetParam().second);
  const auto run = fit("--json");
  ASSERT_EQ(run.exit_code, 1) << run.errors;
  const auto json = nlohmann::json::parse(run.output);
  EXPECT_EQ(json.at("status"), "rank_deficient");
  const auto& rank = json.at("rank");
  EXPECT_LT(rank.at("rank").get<int>(), rank.at("parameters").get<int>());
  std::size_t invisible = 0;
  for (const auto& error : rank.at("errors")) {
    if (error.at("visible").get<bool>()) continue;
    ++invisible;
    EXPECT_NE(error.at("reason"), "") << error.dump();
    EXPECT_NE(error.at("remedy"), "") << error.dump();
  }
  EXPECT_EQ(rank.at("invisible").size(), invisible);
  EXPECT_GT(invisible, 5U);
  EXPECT_LT(invisible, 21U);
}

// Whoever goes on with such a result reads it again.
TEST_P(PartialCampaignProgram, WhatUsesTheResultNamesWhatIsNotSeen) {
  simulate(GetParam().second);
  const auto fitted = fit("--json");
  ASSERT_EQ(fitted.exit_code, 1) << fitted.errors;
  const auto invisible = nlohmann::json::parse(fitted.output).at("rank").at("invisible");
  {
    std::ofstream program(path("part.nc"));
    program << "G21 G90 G17 G54 G49\nG0 X100 Y100 Z-100\nG1 X150 F500\nM30\n";
  }
  const std::string result = path("result");
  for (const std::string& command :
       {"tables " + result + " --dry-run", "tables " + result + " --at X=100",
        "align " + result + " --primary Y --secondary X -o " + path("aligned"),
        "compensate " + result + " " + path("part.nc") + " --check --work-offset G54=X0,Y0,Z0"}) {
    const auto run = run_program(command + " --json");
    ASSERT_EQ(run.exit_code, 1) << command << run.errors;
    EXPECT_EQ(nlohmann::json::parse(run.output).at("invisible"), invisible) << command;
    const auto words = run_program(command);
    EXPECT_EQ(words.exit_code, 1) << command;
    for (const auto& sentence : invisible)
      EXPECT_THAT(words.output, HasSubstr("! " + sentence.get<std::string>())) << command;
  }
}

INSTANTIATE_TEST_SUITE_P(All, PartialCampaignProgram,
                         ::testing::Values(std::pair("BallBarAndDiagonals", kCirclesAndDiagonals),
                                           std::pair("OneTracerSetup", kOneTracerSetup)),
                         [](const auto& tested) { return tested.param.first; });

/// Readings that were computed scatter by their last digit, a ten-thousandth of the noise stated for them,
/// where few positions leave most of every function to its prior.
TEST(ComputedReadings, AreFitted) {
  const testing::ScratchFolder folder;
  const std::string study = (folder.path() / "study").string();
  ASSERT_EQ(run_program("study criticism --one pairs:10 --seed 4001 --readings 1000 -o " + study).exit_code,
            0);
  const std::string exact = study + "/truth/unseen_without_hidden/campaign.toml";
  const auto run = run_program("fit " + exact + " --json -o " + (folder.path() / "result").string());
  EXPECT_EQ(run.exit_code, 1) << run.errors;
  EXPECT_EQ(nlohmann::json::parse(run.output).at("status"), "rank_deficient");
  EXPECT_THAT(run_program("diagnose " + exact).output, HasSubstr("NOTHING_ABOVE"));
}

TEST(TablesProgram, NamesTheFormatsWhenItDoesNotKnowOne) {
  const auto run = run_program("tables r -o t --format ?");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("csv"));
}

}  // namespace
}  // namespace volcal
