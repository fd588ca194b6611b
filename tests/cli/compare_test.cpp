/// `volcal compare` as a user meets it: text, JSON, files, exit codes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"
#include "volcal/identify/report/report.h"

namespace volcal {
namespace {

using testing::content;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kExample = std::string(VOLCAL_SOURCE_DIR) + "/datasets/examples/mixed-1/";

testing::ProgramRun compare(const std::string& arguments) {
  return testing::run_program("compare " + arguments);
}

TEST(Compare, AnswersFirstWhereTheNominalMachineFails) {
  const testing::ProgramRun outcome = compare(kExample + "campaign.toml nominal");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(outcome.errors, "");
  EXPECT_THAT(outcome.output, StartsWith("nominal machine: does not explain the readings, chi2/dof "));
  for (const char* part : {"Residuals by setup", "ISO 230-2:2014", "ISO 230-4:2005", "ISO 230-6:2002",
                           "E_d [um]", "Worst readings"}) {
    EXPECT_THAT(outcome.output, HasSubstr(part));
  }
}

TEST(Compare, AModelWithoutCoefficientsIsTheNominalMachineAndSaysSo) {
  const testing::ProgramRun outcome = compare(kExample + "campaign.toml " + kExample + "model.toml");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, StartsWith("nominal machine ("));
  EXPECT_THAT(outcome.output, HasSubstr("model.toml holds no coefficients"));
}

TEST(Compare, NamesEffectsThatCountAsNothing) {
  const ::volcal::testing::ScratchFolder folder;
  const std::string model = (folder.path() / "model.toml").string();
  std::ofstream(model) << "format = \"volcal-model-1\"\n[functions]\ndefault = { basis = \"zero\" }\n"
                          "[[effects]]\nkind = \"custom\"\ntarget = \"EXX\"\nexpression = \"dir_x\"\n";
  const testing::ProgramRun outcome = compare(kExample + "campaign.toml " + model);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, StartsWith(model + " (without an amplitude, taken as zero: EXX by dir_x)"));
}

/// An angle that somebody read the other way round: by the fit itself, and against a result that is right.
TEST(MisreadReadings, AreNamedByFitAndCompare) {
  const ::volcal::testing::ScratchFolder folder;
  const std::string campaign = (folder.path() / "mixed/campaign.toml").string();
  const std::string result = (folder.path() / "result").string();
  std::filesystem::copy(kExample, folder.path() / "mixed", std::filesystem::copy_options::recursive);
  ASSERT_EQ(testing::run_program("fit " + campaign + " -o " + result).exit_code, 0);
  std::string text = content(campaign);
  const std::string name = "name = \"angXC\"\n";
  ASSERT_NE(text.find(name), std::string::npos);
  text.insert(text.find(name) + name.size(), "scale = { angle_urad = -1 }\n");
  std::ofstream(campaign) << text;
  const std::string said =
      "etup \"angXC\": the other readings expect its angle_urad with the opposite sign: if so add scale = { "
      "angle_urad = -1 }";
  EXPECT_THAT(compare(campaign + " " + result).output, HasSubstr("Note: s" + said));
  EXPECT_THAT(testing::run_program("fit " + campaign + " -o " + result + "2").output,
              HasSubstr("! s" + said));
}

TEST(Compare, JsonIsOneDocumentAndNothingElse) {
  const testing::ProgramRun outcome = compare(kExample + "campaign.toml nominal nominal --json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  const auto json = nlohmann::json::parse(outcome.output);
  ASSERT_EQ(json.at("models").size(), 2U);
  const auto& standards = json.at("models").at(0).at("standards");
  EXPECT_EQ(standards.at("iso230_2").size(), 9U);
  EXPECT_EQ(standards.at("iso230_4").size(), 6U);
  EXPECT_EQ(standards.at("iso230_6").size(), 4U);
  EXPECT_EQ(json.at("models").at(0).at("total").at("observations"), 4712);
}

TEST(Compare, WritesEveryResidual) {
  const ::volcal::testing::ScratchFolder folder;
  const auto target = folder.path() / "comparison";
  const testing::ProgramRun outcome = compare(kExample + "campaign.toml nominal -o " + target.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  const std::string residuals = content(target / "residuals.csv");
  EXPECT_THAT(residuals, StartsWith("setup,row,reading,predicted,residual_um,sigma_um,standardized,"));
  EXPECT_EQ(std::count(residuals.begin(), residuals.end(), '\n'), 1 + 4712);
  EXPECT_TRUE(std::filesystem::exists(target / "comparison.txt"));
  EXPECT_TRUE(nlohmann::json::accept(content(target / "comparison.json")));
  if (report_available()) {
    const std::string report = content(target / "report.html");
    for (const char* section : {"\"circles\"", "\"positioning\"", "\"diagonals\"", "\"setup_residuals\""})
      EXPECT_THAT(report, HasSubstr(std::string("\"kind\":") + section));
  }
}

/// The folder holds what is printed, and the report; without -o nothing is written.
TEST(Validate, WritesFiguresResidualsAndTheReport) {
  const ::volcal::testing::ScratchFolder folder;
  const auto target = folder.path() / "validation";
  const std::string model = (folder.path() / "stated.toml").string();
  std::ofstream(model) << "format = \"volcal-model-1\"\nmachine = \"" << kExample
                       << "machine.toml\"\n[locations]\nEC0Y_urad = 10\n";
  const testing::ProgramRun outcome =
      testing::run_program("validate " + model + " " + kExample + "campaign.toml -o " + target.string());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("written: " + target.string()));
  EXPECT_THAT(outcome.output, StartsWith(content(target / "validation.txt")));
  const auto figures = nlohmann::json::parse(content(target / "validation.json"));
  EXPECT_EQ(figures.at("readings").get<int>() + figures.at("angle_readings").get<int>(), 4712);
  for (const char* file : {"residuals_before.csv", "residuals_after.csv"}) {
    const std::string residuals = content(target / file);
    EXPECT_EQ(std::count(residuals.begin(), residuals.end(), '\n'), 1 + 4712);
  }
  if (report_available()) {
    EXPECT_THAT(content(target / "report.html"), HasSubstr("\"kind\":\"validation\""));
  }
}

TEST(Compare, HeldOutLinesAreJudgedApart) {
  const testing::ProgramRun outcome = compare(kExample + "campaign.toml nominal nominal --held-out --json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  const auto json = nlohmann::json::parse(outcome.output);
  ASSERT_EQ(json.at("held_out").size(), 2U);
  EXPECT_FALSE(json.at("held_out").at(0).at("fitted_without_them").get<bool>());
  const double share = json.at("held_out").at(0).at("total").at("observations").get<double>() / 4712.0;
  EXPECT_NEAR(share, 0.2, 0.06);
  const testing::ProgramRun text = compare(kExample + "campaign.toml nominal nominal --held-out");
  EXPECT_THAT(text.output, HasSubstr("Held-out lines, used in no fit: every fifth"));
  EXPECT_THAT(text.output, HasSubstr("B against A, held-out lines: RMS "));
  EXPECT_THAT(text.output, HasSubstr("(1.000 times)"));
}

TEST(Compare, BadArgumentsAreExitCodeTwo) {
  const testing::ProgramRun missing = compare(kExample + "campaign.toml no-such-model.toml");
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.errors, HasSubstr("no-such-model.toml"));
  EXPECT_EQ(missing.output, "");

  const testing::ProgramRun no_result = compare(kExample + "campaign.toml " + kExample);
  EXPECT_EQ(no_result.exit_code, 2);
  EXPECT_THAT(no_result.errors, HasSubstr("holds no result.json"));

  const testing::ProgramRun three = compare(kExample + "campaign.toml nominal nominal nominal");
  EXPECT_EQ(three.exit_code, 2);
  EXPECT_EQ(compare(kExample + "campaign.toml").exit_code, 2);
}

}  // namespace
}  // namespace volcal
