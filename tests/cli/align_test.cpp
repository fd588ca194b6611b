/// Results turned to another machine coordinate system by the program.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"
#include "tests/support/simulated_campaign.h"

namespace volcal {
namespace {

using testing::content;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_program;

class AlignedResults : public ::testing::Test {
 protected:
  void SetUp() override {
    simulated_.simulate(8,
                        "[[measurements]]\nkind = \"laser-tracer\"\ngrid = [4, 4, 3]\n"
                        "[validation]\npoints = 20\ntools = [\"short\", \"side_x\"]\n",
                        2, 1);
    const auto run = simulated_.fit("--noise white");
    ASSERT_EQ(run.exit_code, 0) << run.errors;
  }
  std::string path(const std::string& name) const { return simulated_.path(name); }
  auto align(const std::string& options) const {
    return run_program("align " + path("result") + " " + options + " -o " + path("aligned"));
  }
  nlohmann::json json_of(const std::string& command) const {
    const auto run = run_program(command + " --json");
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return nlohmann::json::parse(run.output);
  }

 private:
  testing::SimulatedCampaign simulated_;
};

/// Readings of several tools from shared stations are predicted as before; their u differs a little, since
/// how well the turn of the tools is known is not carried along.
TEST_F(AlignedResults, PredictTheSameReadings) {
  const auto aligned = align("--primary Z --secondary X --origin X=100,Y=-50,Z=-200");
  ASSERT_EQ(aligned.exit_code, 0) << aligned.errors;
  EXPECT_THAT(aligned.output, HasSubstr("primary Z, secondary X, origin X=100 Y=-50 Z=-200 mm"));
  for (const char* campaign : {"campaign/campaign.toml", "campaign/truth/campaign.toml"}) {
    const auto before = json_of("validate " + path("result") + " " + path(campaign));
    const auto after = json_of("validate " + path("aligned") + " " + path(campaign));
    for (const auto& [figure, share] : std::map<std::string, double>{
             {"rms_after_um", 1e-4}, {"max_after_um", 1e-4}, {"coverage95", 0.05}, {"reduced_chi2", 0.05}})
      EXPECT_NEAR(after.at(figure).get<double>(), before.at(figure).get<double>(),
                  share * before.at(figure).get<double>())
          << campaign << " " << figure;
  }
}

/// Tables and models of an aligned result are judged in its coordinate system, too; neither holds how well
/// the errors are known.
TEST_F(AlignedResults, AreJudgedAsTablesAndModels) {
  ASSERT_EQ(align("--primary Y --secondary Z --origin X=100,Y=-50,Z=-200").exit_code, 0);
  for (const std::string errors : {"result", "aligned"})
    ASSERT_EQ(run_program("tables " + path(errors) + " --positions 101 --grid 2 -o " + path("of_" + errors))
                  .exit_code,
              0);
  const std::string campaign = path("campaign/truth/campaign.toml");
  const auto rms_after = [&](const std::string& errors) {
    return json_of("validate " + path(errors) + " " + campaign).at("rms_after_um").get<double>();
  };
  const double before = rms_after("result");
  EXPECT_NEAR(rms_after("of_result"), before, 0.02);
  EXPECT_NEAR(rms_after("of_aligned"), before, 0.02);
  EXPECT_NEAR(rms_after("aligned/identified.toml"), before, 0.02);
  const auto models =
      json_of("compare " + campaign + " " + path("of_result") + " " + path("of_aligned")).at("models");
  const auto rms_of = [&](std::size_t model) {
    return models.at(model).at("total").at("lengths_um").at("rms").get<double>();
  };
  EXPECT_NEAR(rms_of(1), rms_of(0), 0.02);
  const auto of_model = json_of("compare " + campaign + " " + path("aligned/identified.toml")).at("models");
  // Of components, where validate has that of vectors.
  EXPECT_NEAR(std::sqrt(3.0) * of_model.at(0).at("total").at("lengths_um").at("rms").get<double>(),
              rms_after("aligned/identified.toml"), 1e-6);
}

TEST_F(AlignedResults, ExplainACampaignAsBefore) {
  ASSERT_EQ(align("--primary Z --secondary X --origin X=100,Y=-50,Z=-200").exit_code, 0);
  const auto compared =
      json_of("compare " + path("campaign/campaign.toml") + " " + path("result") + " " + path("aligned"));
  const auto& models = compared.at("models");
  ASSERT_EQ(models.size(), 2U);
  const double before = models[0].at("total").at("lengths_um").at("rms").get<double>();
  EXPECT_GT(before, 0.1);
  EXPECT_NEAR(models[1].at("total").at("lengths_um").at("rms").get<double>(), before, 1e-4 * before);
}

TEST_F(AlignedResults, HaveAReportWithoutReadings) {
  ASSERT_EQ(align("--primary Y --secondary X").exit_code, 0);
  if (!std::filesystem::exists(path("result/report.html"))) GTEST_SKIP() << "built without Node.js";
  const std::string report = content(path("aligned/report.html"));
  EXPECT_THAT(report, HasSubstr("aligned: primary Y, secondary X"));
  EXPECT_THAT(report, HasSubstr("\"kind\":\"functions\""));
  EXPECT_THAT(report, HasSubstr("\"kind\":\"volume\""));
  EXPECT_THAT(report, Not(HasSubstr("\"kind\":\"residuals\"")));
  EXPECT_THAT(content(path("result/report.html")), HasSubstr("\"kind\":\"residuals\""));
}

TEST_F(AlignedResults, AreReadByTheOtherCommands) {
  ASSERT_EQ(align("--align spindle --spindle-tilt A=12,B=-5").exit_code, 0);
  for (const char* file :
       {"result.json", "residuals.csv", "error_tables.csv", "identified.toml", "machine.toml"})
    EXPECT_TRUE(std::filesystem::exists(path("aligned") + "/" + file)) << file;
  EXPECT_EQ(content(path("aligned/residuals.csv")), content(path("result/residuals.csv")));
  EXPECT_THAT(content(path("aligned/machine.toml")), HasSubstr("primary = \"Z\""));
  EXPECT_THAT(content(path("aligned/error_tables.csv")), HasSubstr("EB0X"));
  const auto tables = run_program("tables " + path("aligned") + " -o " + path("tables"));
  ASSERT_EQ(tables.exit_code, 0) << tables.errors;
  EXPECT_THAT(content(path("tables/metadata.csv")), HasSubstr("alignment,\"primary Z, secondary X"));
  EXPECT_THAT(content(path("tables/metadata.csv")), HasSubstr("along the spindle"));
}

/// tables with the options writes what tables of the aligned result writes.
TEST_F(AlignedResults, AreWhatTablesMakeOnTheirWay) {
  const std::string options = "--primary Y --secondary Z --origin Z=-100";
  ASSERT_EQ(align(options).exit_code, 0);
  const std::string format = " --format neutral-csv --step 100 -o ";
  ASSERT_EQ(run_program("tables " + path("result") + " " + options + format + path("one")).exit_code, 0);
  ASSERT_EQ(run_program("tables " + path("aligned") + format + path("two")).exit_code, 0);
  EXPECT_EQ(content(path("one/correction_grid.csv")), content(path("two/correction_grid.csv")));
}

/// To second order: the tool is turned by 50 urad at most.
TEST_F(AlignedResults, LeaveTheErrorInTheVolumeAsItIs) {
  const std::string tables = "tables " + path("result") + " --format linuxcnc-grid --step 150 --dry-run ";
  const double before = json_of(tables).at("error_left").at("before").at("rms_um");
  for (const char* options : {"--primary Y --secondary X", "--align spindle", "--origin X=0,Y=0,Z=-300"}) {
    const double after = json_of(tables + options).at("error_left").at("before").at("rms_um");
    EXPECT_NEAR(after, before, 1e-3) << options;
  }
}

TEST_F(AlignedResults, RefuseWhatCannotBeDone) {
  const auto refuses = [&](const std::string& options, const char* reason) {
    const auto run = align(options);
    EXPECT_EQ(run.exit_code, 2) << options;
    EXPECT_THAT(run.errors, HasSubstr(reason)) << options;
    EXPECT_FALSE(std::filesystem::exists(path("aligned"))) << options;
  };
  refuses("", "nothing is to be aligned");
  refuses("--primary X --secondary X", "primary and secondary axis are the same");
  refuses("--primary A", "--primary");
  refuses("--origin X=9000", "outside the travel");
  refuses("--primary X --secondary Y --align spindle", "make Z the primary axis");
  refuses("--spindle-tilt A=1", "--align spindle");
  refuses("--align spindle --spindle-tilt A=x", "is not a tilt");
  refuses("--align spindle --spindle-tilt A=20000", "10 mrad");
}

}  // namespace
}  // namespace volcal
