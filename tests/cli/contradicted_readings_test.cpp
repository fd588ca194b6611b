/// Readings that scatter as stated and yet follow something recorded: `volcal fit` and `volcal compare` say
/// that the model lacks something, and what to do next.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>

#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"
#include "volcal/identify/report/report.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_program;

class ContradictedReadings : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  /// The demo machine, a tracer at four stations over `grid`, the column warming up; by default nothing is
  /// hidden.
  std::string simulated(const std::string& grid, const std::string& hidden = "") const {
    std::ofstream(path("study.toml"))
        << "format = \"volcal-study-1\"\nmachine = \"" << VOLCAL_SOURCE_DIR
        << "/datasets/demo/machine.toml\"\nseed = 11\n[[temperatures]]\nchannel = \"column\"\n"
           "start_degC = 22.0\ndrift_K_per_hour = 0.8\namplitude_K = 0.3\nperiod_s = 5400.0\n"
           "[[measurements]]\nkind = \"laser-tracer\"\ngrid = "
        << grid << "\n"
        << hidden;
    const auto run = run_program("simulate " + path("study.toml") + " -o " + path("campaign"));
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return path("campaign/campaign.toml");
  }

  std::string fitted(const std::string& campaign) const {
    const auto run = run_program("fit " + campaign + " -o " + path("result"));
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return run.output;
  }

  std::string compared(const std::string& campaign) const {
    const auto run = run_program("compare " + campaign + " " + path("result"));
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return run.output;
  }

  /// Findings of `volcal validate` on the campaign with side_x stated `millimetres` longer along Z, +- 3 um.
  Json validated_with_tool(const std::string& campaign, double millimetres) const {
    const std::string file = path("campaign/machine.toml");
    const std::string machine = testing::content(file);
    const std::regex offset(R"((\[tools\.side_x\]\s*offset_mm = \[110[.0]*, 15[.0]*, )-240[.0]*\])");
    std::ofstream(file) << std::regex_replace(
        machine, offset, "$1" + std::to_string(-240.0 - millimetres) + "]\noffset_sigma_um = 3.0");
    EXPECT_NE(testing::content(file), machine);
    const auto run = run_program("validate " + path("result") + " " + campaign + " --json");
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    std::ofstream(file) << machine;
    return Json::parse(run.output).value("notes_findings", Json::array());
  }

  std::string report() const { return testing::content(path("result/report.html")); }

  void expect_contradiction(const std::string& campaign) const {
    const std::string next = "\nnext: volcal diagnose " + campaign + " --auto -o diagnosis\n";
    const std::string fit = fitted(campaign);
    EXPECT_THAT(fit, HasSubstr("status lack_of_fit"));
    EXPECT_THAT(fit, HasSubstr("! the residuals are not noise: "));
    EXPECT_THAT(fit, EndsWith(next));
    const Json result = Json::parse(testing::content(path("result/result.json")));
    EXPECT_EQ(result.at("status"), "lack_of_fit");
    if (report_available()) {
      EXPECT_THAT(report(), Not(HasSubstr("The model explains the readings")));
    }
    const std::string compare = compared(campaign);
    EXPECT_THAT(compare, HasSubstr("the residuals are not noise: "));
    EXPECT_THAT(compare, EndsWith(next));
  }

 private:
  testing::ScratchFolder folder_;
};

/// EAX has a step of 1.5 um over Z between seven positions.
TEST_F(ContradictedReadings, ByAStepAtOnePlace) {
  expect_contradiction(std::string(VOLCAL_SOURCE_DIR) + "/datasets/hidden/26/campaign.toml");
}

/// A correlated drift of 0.3 um takes most of it, and no place is worse than chance: the fit's own tests
/// tell.
TEST_F(ContradictedReadings, ByAnExpansionOf2500NanometresPerMetreAndKelvin) {
  expect_contradiction(simulated("[5, 4, 4]",
                                 "[[hidden]]\nkind = \"scale-expansion\"\naxis = \"X\"\n"
                                 "channel = \"column\"\namplitude_um_per_m_K = 2.5\n"));
  EXPECT_THAT(compared(path("campaign/campaign.toml")), HasSubstr("expansion X by column would explain"));
}

TEST_F(ContradictedReadings, ByAToolThatGrowsBy2500NanometresPerKelvin) {
  expect_contradiction(simulated("[6, 5, 4]",
                                 "[[hidden]]\nkind = \"tool-growth-channel\"\nchannel = \"column\"\n"
                                 "amplitude_um = 2.5\n"));
}

TEST_F(ContradictedReadings, OtherwiseNothingIsNext) {
  const std::string campaign = simulated("[5, 4, 4]");
  EXPECT_THAT(fitted(campaign), AllOf(HasSubstr("status ok"), Not(HasSubstr("volcal diagnose"))));
  if (report_available()) {
    EXPECT_THAT(report(), HasSubstr("The model explains the readings"));
  }
  EXPECT_THAT(compared(campaign), AllOf(HasSubstr("no failure found"), Not(HasSubstr("volcal diagnose"))));
}

/// 50 um of a tool that is stated to 3 um.
TEST_F(ContradictedReadings, SayThatAToolIsNotAsStated) {
  const std::string campaign = simulated("[5, 4, 4]");
  fitted(campaign);
  const Json findings = validated_with_tool(campaign, 0.05);
  const auto contradicted = std::ranges::find_if(
      findings, [](const Json& finding) { return finding.at("code") == "prior.contradicted"; });
  ASSERT_NE(contradicted, findings.end()) << findings;
  EXPECT_THAT(contradicted->at("data").at("block").get<std::string>(), HasSubstr("side_x"));
  EXPECT_NEAR(contradicted->at("data").at("miss").at("si").get<double>(), 50e-6, 15e-6);
  for (const Json& finding : validated_with_tool(campaign, 0.0))
    EXPECT_NE(finding.at("code"), "prior.contradicted") << finding;
}

}  // namespace
}  // namespace volcal
