/// Rotary axes counted by the program, small enough for every test run; docs/studies.md has the full one.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/long_tests.h"
#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/study_campaigns.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using testing::run_program;

nlohmann::json five_axis_campaigns(const std::string& options) {
  return testing::campaigns_of_study("five-axis", options);
}

/// One machine of every structure on 12 x 9 poses in every run; at night two on 24 x 13.
TEST(FiveAxisStudy, ErrorsFallAndIntervalsCover) {
  const bool night = testing::long_tests();
  const auto campaigns =
      five_axis_campaigns(night ? "-n 8 --seed 201" : "-n 4 --seed 201 --turns 12 --tilts 9");
  ASSERT_EQ(campaigns.size(), night ? 8U : 4U);
  double coverage = 0.0;
  for (const auto& campaign : campaigns) {
    EXPECT_GT(campaign.at("before_um").get<double>(), 8.0) << campaign.dump();
    EXPECT_LT(campaign.at("after_um").get<double>(), night ? 0.5 : 0.8) << campaign.dump();
    EXPECT_LT(campaign.at("after_beside_um").get<double>(), night ? 3.5 : 4.0) << campaign.dump();
    EXPECT_GT(campaign.at("locations_only_um").get<double>(), campaign.at("after_beside_um").get<double>())
        << campaign.dump();
    EXPECT_NEAR(campaign.at("chi2").get<double>(), 1.0, 0.15) << campaign.dump();
    coverage += campaign.at("coverage").get<double>() / static_cast<double>(campaigns.size());
  }
  EXPECT_GT(coverage, 0.88);
}

/// What is finished is not run again, a line that was cut off is, and another seed is refused.
TEST(FiveAxisStudy, GoesOnWhereItWasInterrupted) {
  const testing::ScratchFolder scratch;
  const std::string folder = (scratch.path() / "kept").string();
  const std::string small = "--turns 4 --tilts 4 --seed 7 -o " + folder;
  const auto two = five_axis_campaigns("-n 2 " + small);
  const std::filesystem::path file = std::filesystem::path(folder) / "campaigns.jsonl";
  std::string lines = testing::content(file);
  const auto first_end = lines.find('\n');
  std::ofstream(file, std::ios::trunc) << lines.substr(0, first_end + 20);
  EXPECT_EQ(five_axis_campaigns("-n 2 --resume " + small), two);
  EXPECT_EQ(testing::content(file).size(), lines.size());
  EXPECT_THAT(run_program("study five-axis -n 2 " + small).errors, HasSubstr("--resume"));
  EXPECT_THAT(run_program("study five-axis -n 2 --resume --turns 4 --tilts 4 --seed 8 -o " + folder).errors,
              HasSubstr("another seed or grid"));
  std::ofstream(file, std::ios::app) << std::string(100000, '[') << '\n';
  const auto nested = run_program("study five-axis -n 2 --resume " + small);
  EXPECT_EQ(nested.exit_code, 2) << "a line of brackets exhausts no stack";
  EXPECT_THAT(nested.errors, HasSubstr("campaigns.jsonl"));
}

}  // namespace
}  // namespace volcal
