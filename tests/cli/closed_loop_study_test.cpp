/// The closed loop counted by the program, small enough for every test run; docs/studies.md has the full one.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/scratch_folder.h"

namespace volcal {
namespace {

class ClosedLoopStudy : public ::testing::Test {
 protected:
  int volcal(const std::string& arguments) {
    const std::string command = std::string(VOLCAL_PROGRAM) + " " + arguments + " >" + path("output") +
                                " 2>" + path("errors") + " </dev/null";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string path(const std::string& name) const { return (scratch_.path() / name).string(); }
  std::string content(const std::string& name) const {
    std::ifstream file(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  testing::ScratchFolder scratch_;
};

TEST_F(ClosedLoopStudy, AutomaticResolutionIsAsGoodAsHindsightAndItsIntervalsHold) {
  ASSERT_EQ(volcal("study closed-loop -n 8 --seed 301 --small --fixed --json"), 0) << content("errors");
  const auto json = nlohmann::json::parse(content("output"));
  ASSERT_EQ(json.at("campaigns").size(), 8U);
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

TEST_F(ClosedLoopStudy, DoesNotDependOnTheNumberOfThreads) {
  ASSERT_EQ(volcal("study closed-loop -n 2 --small --json --threads 1"), 0) << content("errors");
  const std::string one = content("output");
  ASSERT_EQ(volcal("study closed-loop -n 2 --small --json --threads 2"), 0) << content("errors");
  EXPECT_EQ(one, content("output"));
}

TEST_F(ClosedLoopStudy, NamesAnUnknownStudy) {
  EXPECT_EQ(volcal("study no-such-study"), 2);
  EXPECT_THAT(content("errors"), ::testing::HasSubstr("no-such-study"));
}

}  // namespace
}  // namespace volcal
