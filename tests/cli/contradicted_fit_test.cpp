/// What readings contradict is said wherever the errors of such a fit are used.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;
using testing::run_program;

class ContradictedFit : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new testing::ScratchFolder;
    const std::string campaign = std::string(VOLCAL_SOURCE_DIR) + "/datasets/hidden/21";
    const auto fitted =
        run_program("fit " + campaign + "/campaign.toml -m " + campaign + "/model.toml -o " + path("result"));
    ASSERT_EQ(fitted.exit_code, 0) << fitted.errors;
    ASSERT_THAT(fitted.output, HasSubstr("lack_of_fit"));
    std::ofstream(path("part.nc")) << "G21 G90 G94\nG0 X10 Y10 Z-10\nG1 X20 F1000\nM2\n";
  }
  static void TearDownTestSuite() { delete folder_; }
  static std::string path(const std::string& name) { return (folder_->path() / name).string(); }

  static testing::ScratchFolder* folder_;
};
testing::ScratchFolder* ContradictedFit::folder_ = nullptr;

TEST_F(ContradictedFit, IsNamedBesideWhatIsMadeOfIt) {
  const std::string result = path("result");
  for (const std::string& command :
       {"tables " + result + " --format csv -o " + path("tables"), "budget " + result,
        "compensate " + result + " " + path("part.nc") + " --work-offset G54=X0,Y0,Z0 -o " +
            path("compensated.nc"),
        "export " + result + " --npz " + path("result.npz"),
        "align " + result + " --primary Y --secondary X -o " + path("aligned")}) {
    const auto run = run_program(command);
    EXPECT_EQ(run.exit_code, 0) << command << "\n" << run.errors;
    EXPECT_THAT(run.output, HasSubstr("`volcal diagnose` tells")) << command;
  }
}

TEST_F(ContradictedFit, IsSaidInTheAnswersForOtherPrograms) {
  const auto run = run_program("budget " + path("result") + " --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_FALSE(Json::parse(run.output).at("contradicted").empty());
}

/// Draws are of the fitted model: where readings contradict it they show less than the whole error.
TEST_F(ContradictedFit, IsSaidBesideDrawsOfIt) {
  const std::string campaign = std::string(VOLCAL_SOURCE_DIR) + "/datasets/hidden/21";
  const std::string drawn = "montecarlo " + campaign + "/campaign.toml -m " + campaign +
                            "/model.toml --path linear -n 1000 --refits 0 -o " + path("drawn");
  const auto text = run_program(drawn);
  ASSERT_EQ(text.exit_code, 0) << text.errors;
  EXPECT_THAT(text.output, HasSubstr("`volcal diagnose` tells"));
  EXPECT_THAT(testing::content(path("drawn/montecarlo.txt")), HasSubstr("`volcal diagnose` tells"));
  const auto json = run_program(drawn + " --json");
  ASSERT_EQ(json.exit_code, 0) << json.errors;
  const Json findings = Json::parse(json.output).at("contradicted_findings");
  ASSERT_FALSE(findings.empty());
  EXPECT_EQ(findings.back().at("code"), "model.contradicted");
}

}  // namespace
}  // namespace volcal
