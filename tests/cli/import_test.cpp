/// `volcal import` as a user runs it: files become a campaign that other commands take.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/import_files.h"
#include "tests/support/program.h"

namespace volcal {
namespace {

using testing::content;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::ProgramRun;
using testing::run_program;

class ImportCommand : public ::testing::Test {
 protected:
  ImportCommand() { write("machine.toml", testing::kImportMachine); }
  std::string path(const std::string& name) const { return (scratch_.path() / name).string(); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(scratch_.path() / name, std::ios::binary) << text;
  }
  ProgramRun import(const std::string& files, const std::string& options) const {
    return run_program("import " + files + " --machine " + path("machine.toml") + " -o " + path("campaign") +
                       " --set 'noise = { constant_um = 0.3 }' --set 'repeatability_um = 0.3' " + options);
  }
  static constexpr const char* kAt = "--at Y=250,Z=150 ";

  testing::ScratchFolder scratch_;
};

/// By hand in tests/support/import_files.h.
TEST_F(ImportCommand, RunsOfALaserGiveTheFiguresOfIso2302) {
  write("x.rtl", testing::with_line_ends(testing::rtl_text(), "\r\n"));
  const ProgramRun run = import(path("x.rtl"), std::string("--unit um ") + kAt);
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("order of the runs"));
  const ProgramRun compared = run_program("compare " + path("campaign/campaign.toml") + " nominal --json");
  ASSERT_EQ(compared.exit_code, 0) << compared.errors;
  const auto figures =
      nlohmann::json::parse(compared.output)["models"][0]["standards"]["iso230_2"][0]["readings"];
  const double s = std::sqrt(2.0);
  EXPECT_NEAR(figures["B_um"].get<double>(), 3.0, 1e-3);
  EXPECT_NEAR(figures["E_um"].get<double>(), 7.0, 1e-3);
  EXPECT_NEAR(figures["M_um"].get<double>(), 4.0, 1e-3);
  EXPECT_NEAR(figures["A_um"].get<double>(), 7.0 + 4.0 * s, 1e-3);
  EXPECT_NEAR(figures["R_um"].get<double>(), 3.0 + 4.0 * s, 1e-3);
}

/// Of both directions the deviation grows by 4 um over 200 mm: EXX, which is zero at home, is +4 um there.
TEST_F(ImportCommand, AFitFindsTheErrorWithItsSign) {
  write("x.rtl", testing::rtl_text());
  ASSERT_EQ(import(path("x.rtl"), std::string("--unit um ") + kAt).exit_code, 0);
  write(
      "campaign/model.toml",
      "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n[functions]\ndefault = { basis = \"zero\" }\n"
      "EXX = { basis = \"bspline\", degree = 1, knots = 1 }\n");
  const ProgramRun fit = run_program("fit " + path("campaign/campaign.toml") + " --model " +
                                     path("campaign/model.toml") + " --noise white -o " + path("result"));
  ASSERT_LE(fit.exit_code, 1) << fit.errors;
  std::istringstream table(content(scratch_.path() / "result/error_tables.csv"));
  double found = 0.0;
  for (std::string line; std::getline(table, line);) {
    double position = 0.0, value = 0.0;
    if (std::sscanf(line.c_str(), "EXX,X,%lf,mm,%*[^,],%lf", &position, &value) == 2 && position == 200.0)
      found = value;
  }
  EXPECT_NEAR(found, 4.0, 0.05) << content(scratch_.path() / "result/error_tables.csv").substr(0, 600);
}

TEST_F(ImportCommand, SeveralFilesWithTheirOwnAnswers) {
  write("x.rtl", testing::rtl_text());
  write("y.rtl", testing::replaced(testing::sorted_rtl_text(), "Axis: X", "Axis: Y"));
  const ProgramRun run = import(path("x.rtl") + " " + path("y.rtl"),
                                "--unit um --runs y:alternating --at x:Y=250,Z=150 --at y:X=100,Z=50 --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto json = nlohmann::json::parse(run.output);
  EXPECT_EQ(json["files"].size(), 2U);
  EXPECT_EQ(json["files"][1]["setup"], "y");
  EXPECT_EQ(json["files"][1]["readings"], 12);
  EXPECT_THAT(content(scratch_.path() / "campaign/y.csv"), HasSubstr("x_mm,y_mm"));
  EXPECT_THAT(content(scratch_.path() / "campaign/campaign.toml"), HasSubstr("# y: imported from y.rtl"));
}

TEST_F(ImportCommand, NothingIsWrittenWithoutAnAnswer) {
  write("x.rtl", testing::sorted_rtl_text());
  const ProgramRun run = import(path("x.rtl"), std::string("--unit um ") + kAt);
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("--runs forward, backward or alternating"));
  EXPECT_FALSE(std::filesystem::exists(path("campaign")));
}

TEST_F(ImportCommand, AGuessIsShownAndConfirmed) {
  write("t.csv", "Soll X [mm];Abweichung [\xB5m]\n0,0;-1,5\n100,0;2,25\n200,0;3,0\n");
  const std::string options = std::string("--instrument displacement ") + kAt;
  EXPECT_THAT(import(path("t.csv"), options).errors,
              HasSubstr("t.csv:1: the file is not UTF-8 text (give --encoding cp1252"));
  const ProgramRun unconfirmed = import(path("t.csv"), options + "--encoding cp1252");
  EXPECT_EQ(unconfirmed.exit_code, 2);
  EXPECT_THAT(unconfirmed.output, HasSubstr("deviation_um, in \u00B5m"));
  EXPECT_THAT(unconfirmed.output, HasSubstr("guessed"));
  EXPECT_THAT(unconfirmed.errors, HasSubstr("add --yes"));
  EXPECT_FALSE(std::filesystem::exists(path("campaign")));
  const ProgramRun confirmed = import(path("t.csv"), options + "--encoding cp1252 --yes");
  EXPECT_EQ(confirmed.exit_code, 0) << confirmed.errors;
  EXPECT_EQ(run_program("compare " + path("campaign/campaign.toml") + " nominal").exit_code, 0);
}

/// Of 1 um on 500 mm and 2 um on 1000 mm down to 0: EXX rises with X.
TEST_F(ImportCommand, ADecimalSignThatStaysOpenIsAskedFor) {
  write("machine.toml", testing::replaced(testing::kImportMachine, "500.0", "1000.0"));
  write("t.txt", "Soll X [mm]\tAbweichung [um]\n1,000\t2\n500\t1\n0\t0\n");
  const std::string options = std::string("--instrument displacement --yes ") + kAt;
  const ProgramRun open = import(path("t.txt"), options);
  EXPECT_EQ(open.exit_code, 2);
  EXPECT_THAT(open.errors, HasSubstr("give --decimal comma or --decimal point"));
  const ProgramRun run = import(path("t.txt"), options + "--decimal t:point");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(content(scratch_.path() / "campaign/t.csv"), HasSubstr("\n1000,"));
  EXPECT_THAT(content(scratch_.path() / "campaign/campaign.toml"), HasSubstr("direction = [1"));
  EXPECT_THAT(import(path("t.txt"), options + "--decimal dot").errors, HasSubstr("--decimal is \"dot\""));
}

TEST_F(ImportCommand, ATrackersListWithItsCommandedPositions) {
  const testing::SampleImport sample = testing::sample_point_lists()[1];
  write("points.txt", sample.bytes);
  write("commanded.csv", sample.nominal);
  const ProgramRun run = run_program("import " + path("points.txt") + " --machine " + path("machine.toml") +
                                     " -o " + path("campaign") + " --nominal " + path("commanded.csv") +
                                     " --horizontal clockwise --vertical zenith"
                                     " --set 'noise = { constant_um = 5, angle_urad = 5 }'");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(content(scratch_.path() / "campaign/campaign.toml"), HasSubstr("laser-tracker"));
  EXPECT_EQ(run_program("compare " + path("campaign/campaign.toml") + " nominal").exit_code, 0);
}

TEST_F(ImportCommand, DamagedFilesAndOptionsAreRefused) {
  write("x.rtl", testing::replaced(testing::rtl_text(), "2   2      -1.0\n", "2   2      -1.0 um\n"));
  EXPECT_THAT(import(path("x.rtl"), std::string("--unit um ") + kAt).errors, HasSubstr("x.rtl:31:"));
  write("letter.txt", "Dear Sir,\n");
  EXPECT_THAT(import(path("letter.txt"), "").errors, HasSubstr("letter.txt:1: the file is not understood"));
  write("x.rtl", testing::rtl_text());
  const std::string good = std::string("--unit um ") + kAt;
  EXPECT_THAT(import(path("x.rtl"), good + "--at 5").errors, HasSubstr("--at is given twice"));
  EXPECT_THAT(import(path("x.rtl"), "--unit um --at Q=3").errors, HasSubstr("not a position of an axis"));
  EXPECT_THAT(import(path("x.rtl"), good + "--set 'noise'").errors, HasSubstr("not a key and a value"));
  EXPECT_THAT(import(path("x.rtl"), good + "--set 'colour = 3'").errors, HasSubstr("colour"));
  EXPECT_THAT(import(path("x.rtl"), good + "--tool drill").errors, HasSubstr("--tool drill"));
  EXPECT_THAT(import(path("x.rtl"), good + "--encoding cp1").errors, HasSubstr("--encoding \"cp1\""));
  EXPECT_THAT(import(path("x.rtl"), good + "--format tracker").errors, HasSubstr("x.rtl:"));
  EXPECT_THAT(import(path("missing.rtl"), good).errors, HasSubstr("does not exist"));
  for (const char* options : {"--set 'noise'", "--tool drill"}) {
    const ProgramRun run = import(path("x.rtl"), good + options);
    EXPECT_EQ(run.exit_code, 2) << options;
    EXPECT_THAT(run.errors, Not(HasSubstr("terminate"))) << options;
  }
}

}  // namespace
}  // namespace volcal
