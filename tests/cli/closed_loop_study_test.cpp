/// The closed loop counted by the program, small enough for every test run; docs/studies.md has the full one.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/long_tests.h"
#include "tests/support/program.h"
#include "tests/support/study_campaigns.h"

namespace volcal {
namespace {

using testing::run_program;

/// One campaign of every structure in every run, two for the night.
TEST(ClosedLoopStudy, AutomaticResolutionIsAsGoodAsHindsightAndItsIntervalsHold) {
  const int count = testing::short_or_long(4, 8);
  const auto run =
      run_program("study closed-loop -n " + std::to_string(count) + " --seed 301 --small --fixed --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto json = nlohmann::json::parse(run.output);
  ASSERT_EQ(json.at("campaigns").size(), static_cast<std::size_t>(count));
  SCOPED_TRACE(json.at("summary").back().dump(1));
  for (const auto& campaign : json.at("campaigns")) {
    const auto& fixed = campaign.at("rms_fixed_um");
    const double best = *std::min_element(fixed.begin(), fixed.end());
    EXPECT_LT(campaign.at("rms_after_um").get<double>(), 1.15 * best) << campaign.dump();
    EXPECT_NEAR(campaign.at("reduced_chi2").get<double>(), 1.0, 0.15) << campaign.dump();
    EXPECT_GT(campaign.at("rms_before_um").get<double>(), 10.0);
  }
  EXPECT_GT(json.at("summary").back().at("mean_coverage95").get<double>(), 0.88);
}

// The laser's scale and the tools are wrong in every campaign by what it states.
TEST(ClosedLoopStudy, IntervalsHoldWithSharedSources) {
  const auto campaigns = [](const std::string& options) {
    return testing::campaigns_of_study("closed-loop", "--seed 401 --small " + options);
  };
  const auto shared = campaigns("-n 4 --shared");
  double sum = 0.0;
  for (const auto& campaign : shared) sum += campaign.at("coverage95").get<double>();
  EXPECT_GT(sum / static_cast<double>(shared.size()), 0.88);
  EXPECT_NE(shared[0].at("rms_after_um"), campaigns("-n 1")[0].at("rms_after_um"));
}

TEST(ClosedLoopStudy, DoesNotDependOnTheNumberOfThreads) {
  VOLCAL_FOR_THE_NIGHT(
      "CompensationStudy.DoesNotDependOnTheNumberOfThreads, by the same loop over campaigns");
  const auto one = run_program("study closed-loop -n 2 --small --json --threads 1");
  const auto two = run_program("study closed-loop -n 2 --small --json --threads 2");
  ASSERT_EQ(one.exit_code, 0) << one.errors;
  EXPECT_EQ(one.output, two.output);
}

TEST(ClosedLoopStudy, NamesAnUnknownStudy) {
  const auto run = run_program("study no-such-study");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, ::testing::HasSubstr("no-such-study"));
}

}  // namespace
}  // namespace volcal
