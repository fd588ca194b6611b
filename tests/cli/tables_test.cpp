/// Volumetric errors at points that the user names, and tables for controllers.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/simulated_campaign.h"

namespace volcal {
namespace {

using testing::content;
using ::testing::HasSubstr;
using testing::run_program;

class TablesAtPoints : public ::testing::Test {
 protected:
  void SetUp() override {
    simulated_.simulate(8,
                        "[[measurements]]\nkind = \"laser-tracer\"\ngrid = [3, 3, 3]\n"
                        "[validation]\npoints = 5\n",
                        2, 1);
    const auto run = simulated_.fit("--noise white");
    ASSERT_EQ(run.exit_code, 0) << run.errors;
  }

  std::string path(const std::string& name) const { return simulated_.path(name); }
  auto tables(const std::string& options) const {
    return run_program("tables " + path("result") + " " + options);
  }
  /// Cells of the row of volumetric_grid.csv for a tool at the first corner of the travel.
  std::vector<std::string> first_row() const {
    std::istringstream lines(content(path("result/volumetric_grid.csv")));
    std::string line;
    std::getline(lines, line);  // names
    std::getline(lines, line);
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    return cells;
  }

 private:
  testing::SimulatedCampaign simulated_;
};

TEST_F(TablesAtPoints, AgreeWithTheGrid) {
  const std::vector<std::string> row = first_row();
  ASSERT_EQ(row.size(), 17U);
  const auto run =
      tables("--at X=" + row[0] + ",Y=" + row[1] + ",Z=" + row[2] + " --tool " + row[3] + " --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto errors = nlohmann::json::parse(run.output).at("volumetric_errors");
  ASSERT_EQ(errors.size(), 1U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(errors[0].at("error_um")[k].get<double>(), std::stod(row[4 + k]), 1e-6);
    EXPECT_NEAR(errors[0].at("rotation_urad")[k].get<double>(), std::stod(row[7 + k]), 1e-6);
    EXPECT_NEAR(errors[0].at("u_um")[k].get<double>(), std::stod(row[10 + k]), 1e-4);
    EXPECT_GT(errors[0].at("u_um")[k].get<double>(), 0.0);
    EXPECT_NEAR(errors[0].at("u_rotation_urad")[k].get<double>(), std::stod(row[13 + k]), 1e-4);
  }
  EXPECT_EQ(errors[0].at("tool"), row[3]);
  EXPECT_EQ(errors[0].at("extrapolated").get<bool>(), row[16] == "1");
}

/// By the datum every function is zero at home, without the rounding of its coefficients.
TEST_F(TablesAtPoints, OfFunctionsAreZeroAtHome) {
  const std::map<std::string, std::string> home = {{"X", "-400"}, {"Y", "-250"}, {"Z", "0"}};
  std::istringstream lines(content(path("result/error_tables.csv")));
  int found = 0;
  for (std::string line; std::getline(lines, line);) {
    for (const auto& [axis, position] : home) {
      const std::string place = "," + axis + "," + position + ",mm,0,";
      if (line.find(place) == std::string::npos) continue;
      EXPECT_THAT(line, ::testing::ContainsRegex(place + "0,u(m|rad),0,0,0$"));
      ++found;
    }
  }
  EXPECT_EQ(found, 18);
}

TEST_F(TablesAtPoints, ListEveryToolAndWriteTheTablesBeside) {
  const auto run = tables("--at X=10 --at Y=20,Z=-30 -o " + path("tables"));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("ex +- U95 [um]"));
  EXPECT_THAT(run.output, HasSubstr("volumetric_grid.csv"));
  const auto json = nlohmann::json::parse(tables("--at X=10 --at Y=20,Z=-30 --json").output);
  const auto machine = nlohmann::json::parse(content(path("result/result.json"))).at("machine");
  const auto& errors = json.at("volumetric_errors");
  ASSERT_EQ(errors.size(), 2 * machine.at("tools").size());
  EXPECT_EQ(errors[0].at("position").at("X"), 10.0);
  EXPECT_EQ(errors[0].at("position").at("Y"), -250.0) << "not named: at home";
}

TEST_F(TablesAtPoints, RefuseWhatIsNoPoint) {
  const std::vector<std::pair<std::string, std::string>> refused = {
      {"", "give -o FOLDER"},
      {"--tool long", "give -o FOLDER"},
      {"--at 100,200", "write axes and positions"},
      {"--at X=ten", "is not a number"},
      {"--at X=nan", "is not a number"},
      {"--at X=1,X=2", "X is given twice"},
      {"--at A=1", "its axes are X Y Z"},
      {"--at X=1e6", "outside the travel of X"},
      {"--at X=1 --tool wrong", "the machine has no such tool"},
  };
  for (const auto& [options, message] : refused) {
    const auto run = tables(options);
    EXPECT_EQ(run.exit_code, 2) << options;
    EXPECT_THAT(run.errors, HasSubstr(message)) << options;
    EXPECT_EQ(run.output, "") << options;
  }
}

TEST_F(TablesAtPoints, SayWhatACompensationWouldLeaveAndWriteNothing) {
  const auto run = tables("--format linuxcnc --dry-run");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("linuxcnc L-POS, tool short, step "));
  EXPECT_THAT(run.output, HasSubstr("ideal L-POS"));
  EXPECT_THAT(run.output, HasSubstr("not written: x.comp, y.comp, z.comp, compensation.ini"));
  const auto json = nlohmann::json::parse(tables("--format neutral-csv --step 50 --dry-run --json").output);
  EXPECT_EQ(json.at("type"), "L-VOL");
  EXPECT_EQ(json.at("step_mm"), 50.0);
  const auto& left = json.at("error_left");
  EXPECT_LT(left.at("tables").at("rms_um").get<double>(), 0.1 * left.at("before").at("rms_um").get<double>());
  EXPECT_FALSE(std::filesystem::exists(path("tables")));
}

TEST_F(TablesAtPoints, WriteTheFilesOfAFormat) {
  const auto run =
      tables("--format sinumerik --tolerance 1 --tool side_x --lines X=0,Y=0,Z=-200 -o " + path("out"));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(content(path("out/AX_EEC.INI")), ::testing::StartsWith("%_N_AX_EEC_INI\nCHANDATA(1)\n"));
  EXPECT_THAT(run.output, HasSubstr("sinumerik L-POS, tool side_x"));
  EXPECT_THAT(run.output, HasSubstr("Verified: read back by volcal; not tried on a controller."));
}

TEST_F(TablesAtPoints, WriteTablesThatAreEnteredByHand) {
  const auto heidenhain = tables("--format heidenhain --set sign=error --step 50 -o " + path("heidenhain"));
  ASSERT_EQ(heidenhain.exit_code, 0) << heidenhain.errors;
  EXPECT_THAT(heidenhain.output, HasSubstr("sign of the values is NOT confirmed"));
  EXPECT_THAT(content(path("heidenhain/X.COM.txt")), HasSubstr("ERRORS\nAXISPOS X Y Z\n-400.0000 "));
  EXPECT_THAT(content(path("heidenhain/CONFIG.CMA.txt")), HasSubstr("* X.COM Y.COM Z.COM"));
  const auto spacing = tables("--format heidenhain --set sign=error --set rows=spacing --step 20 --dry-run");
  ASSERT_EQ(spacing.exit_code, 0) << spacing.errors;
  EXPECT_THAT(spacing.output, HasSubstr("step 13.1072 mm")) << "2^17 digits of 0.1 um";
  const auto fanuc = tables(
      "--format fanuc --set sign=compensation --set output=even --set directions=mean -o " + path("fanuc"));
  ASSERT_EQ(fanuc.exit_code, 0) << fanuc.errors;
  EXPECT_THAT(content(path("fanuc/pitch_error.txt")),
              HasSubstr("REFERENCE X -400.0000\n3605#0 X 0\n3620 X 0\n"));
  const auto again = tables("--format neutral-csv --superimpose " + path("fanuc") + " --dry-run");
  EXPECT_EQ(again.exit_code, 0) << again.errors;
}

/// Where a table has a row, its trim in mm is the correction at that point.
TEST_F(TablesAtPoints, SayWhatTheTablesAdd) {
  const std::string options = "--format linuxcnc --step 50 --at X=100,Y=50,Z=-150";
  const auto json = nlohmann::json::parse(tables(options + " --json -o " + path("out")).output);
  ASSERT_EQ(json.at("corrections").size(), 1U);
  const auto& added = json.at("corrections")[0];
  EXPECT_EQ(added.at("position").at("Z"), -150.0);
  EXPECT_EQ(added.at("correction_um").size(), 8U);
  const std::vector<std::pair<std::string, std::string>> rows = {
      {"out/x.comp", "100.000000 "}, {"out/y.comp", "50.000000 "}, {"out/z.comp", "-150.000000 "}};
  for (std::size_t axis = 0; axis < rows.size(); ++axis) {
    const std::string text = "\n" + content(path(rows[axis].first));
    const auto row = text.find("\n" + rows[axis].second);
    ASSERT_NE(row, std::string::npos) << text;
    const double trim_mm = std::stod(text.substr(row + 1 + rows[axis].second.size()));
    EXPECT_GT(std::abs(trim_mm), 1e-5);
    EXPECT_NEAR(added.at("correction_um").at("+-+")[axis].get<double>(), 1e3 * trim_mm, 1e-6);
  }
  const auto run = tables(options + " --dry-run");
  EXPECT_THAT(run.output, HasSubstr("Added to the command by the tables read back"));
  EXPECT_THAT(run.output, ::testing::ContainsRegex("100.000 +50.0000 +-150.000 +towards - "));
}

TEST_F(TablesAtPoints, RecordTheConditions) {
  const auto run = tables("-o " + path("out") + " --record feed=1000 --record \"load=none, empty\"");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(content(path("out/metadata.csv")), HasSubstr("load,\"none, empty\"\nfeed,1000\n"));
}

TEST_F(TablesAtPoints, RefuseWhatAFormatCannotDo) {
  const std::vector<std::pair<std::string, std::string>> refused = {
      {"--format linuxcnc --type L-VOL", "acts on its own joint only"},
      {"--format klipper --type L-POS", "three skew factors"},
      {"--format sinumerik-cec", "cec_sign is not confirmed publicly"},
      {"--format sinumerik-cec --set cec_sign=up", "--set cec_sign=error"},
      {"--format fanuc", "sign is not confirmed publicly"},
      {"--format fanuc --set sign=error", "give --set output=even"},
      {"--format fanuc --type L-STR", "acts on its own axis only"},
      {"--format heidenhain", "sign is not confirmed publicly"},
      {"--format heidenhain --type L-VOL", "depends on one axis"},
      {"--format sinumerik-vcs", "no public grammar"},
      {"--format wrong", "is not a table format"},
      {"--format linuxcnc --set sign=1", "has no such setting"},
      {"--format linuxcnc --set units", "write NAME=VALUE"},
      {"--format linuxcnc --set units=mm --set units=mm", "given twice"},
      {"--format linuxcnc --step 0.5", "a table holds 256"},
      {"--format linuxcnc --step 0", "must be positive"},
      {"--format linuxcnc --step 5 --tolerance 1", "excludes"},
      {"--format linuxcnc --tool wrong", "the machine has no such tool"},
      {"--format linuxcnc --lines X=1e9", "outside the travel of X"},
      {"--type L-VOL+R-VOL", "no error of a rotary axis was identified"},
      {"--format linuxcnc --type R-POS", "holds nothing of rotary axes"},
      {"--format neutral-csv --type L-VOL+", "which no table holds"},
      {"--type L-POS", "the whole model"},
      {"--record weather=fine", "record one of machine_state"},
  };
  for (const auto& [options, message] : refused) {
    const auto run = tables(options + " --dry-run");
    EXPECT_EQ(run.exit_code, 2) << options;
    EXPECT_THAT(run.errors, HasSubstr(message)) << options;
    EXPECT_EQ(run.output, "") << options;
  }
}

TEST(TablesList, NamesFormatsTypesAndLimitsWithoutAResult) {
  const auto run = run_program("tables --list");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  for (const char* text :
       {"linuxcnc\n", "at most 256 positions a table", "types: L-POS;", "verified:", "L-ANG (8.2.5)"})
    EXPECT_THAT(run.output, HasSubstr(text));
  const auto json = nlohmann::json::parse(run_program("tables --list --json").output);
  EXPECT_GE(json.at("formats").size(), 9U);
  const auto nothing = run_program("tables");
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.errors, HasSubstr("no result is given"));
}

}  // namespace
}  // namespace volcal
