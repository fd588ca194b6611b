/// Volumetric errors at points that the user names.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
      {"--tool long", "without --at"},
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

}  // namespace
}  // namespace volcal
