/// Known errors go in wherever errors do: exercise 3 of the teaching paper, a machine simulated from a model,
/// from tables and from a result, alignment of a model, and an error budget before anything is built.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/simulated_campaign.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_program;

const std::string kExercises = VOLCAL_SOURCE_DIR "/datasets/exercises/";

// Table 2 of the paper, to the printed micrometre.
TEST(Exercise3, IsOneCommand) {
  const std::vector<double> printed = {0, 8, 60, 81, 76, 17, -18, -47, -54};
  std::string arguments = "tables " + kExercises + "slideway.toml --json";
  for (std::size_t y = 0; y < printed.size(); ++y) arguments += " --at Y=" + std::to_string(y);
  const auto run = run_program(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json errors = Json::parse(run.output).at("volumetric_errors");
  ASSERT_EQ(errors.size(), printed.size());
  for (std::size_t y = 0; y < printed.size(); ++y)
    EXPECT_EQ(std::round(errors[y].at("error_um")[1].get<double>()), printed[y]) << "y = " << y << " mm";
}

TEST(Exercise3, PrintsNoUncertaintyWhereNoneIsStated) {
  const auto run = run_program("tables " + kExercises + "slideway.toml --at Y=1");
  EXPECT_THAT(run.output, HasSubstr("without a stated uncertainty"));
  EXPECT_THAT(run.output, Not(HasSubstr("+-")));
  const auto json = run_program("tables " + kExercises + "slideway.toml --at Y=1 --json");
  EXPECT_TRUE(Json::parse(json.output).at("volumetric_errors")[0].at("u_um").is_null());
}

constexpr const char* kKnown = R"(
[functions]
default = { basis = "zero" }
EXX = { basis = "legendre", degree = 3, coefficients_um = [6.0, 9.0, -4.0, 2.0] }
EYX = { basis = "bspline", degree = 2, knots = 3, coefficients_um = [0.0, 5.0, -6.0, 4.0, 1.0] }
EAY = { basis = "bspline", degree = 3, knots = 2, coefficients_urad = [0.0, 12.0, -20.0, 9.0, 15.0] }
ECZ = { basis = "bspline", degree = 1, knots_mm = [-450, -300, 0], coefficients_urad = [18.0, -7.0, 0.0] }
EZZ = { basis = "legendre", degree = 2, coefficients_um = [1.0, -7.0, 3.0] }
[locations]
EC0Y_urad = 22.0
EB0Z_urad = -14.0
[[effects]]
kind = "reversal"
symbol = "EXX"
amplitude_um = 3.0
[[effects]]
kind = "axis-coupling"
symbol = "EAY"
axis = "Z"
amplitude_urad_per_m = 25.0
[[effects]]
kind = "scale-expansion"
axis = "X"
temperature = "air"
amplitude_um_per_m_K = 11.0
)";

constexpr const char* kMeasured = R"(
[[temperatures]]
channel = "air"
start_degC = 21.0
drift_K_per_hour = 1.0
[[measurements]]
kind = "point-grid"
grid = [5, 4, 4]
noise = { constant_um = 0.0001, per_metre_um = 0.0, repeatability_um = 0.0 }
[[measurements]]
kind = "laser-tracer"
grid = [4, 3, 3]
noise = { constant_um = 0.0001, per_metre_um = 0.0, repeatability_um = 0.0 }
)";

class KnownErrors : public ::testing::Test {
 protected:
  void SetUp() override {
    write("known.toml",
          "format = \"volcal-model-1\"\nmachine = \"" + testing::kDemoMachine + "\"\n" + kKnown);
    write("study.toml",
          "format = \"volcal-study-1\"\nmachine = \"" + testing::kDemoMachine + "\"\nseed = 5\n" + kMeasured);
  }

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }

  std::string done(const std::string& arguments) const {
    const auto run = run_program(arguments);
    EXPECT_EQ(run.exit_code, 0) << arguments << "\n" << run.errors << run.output;
    return run.output;
  }
  void refused(const std::string& arguments, const std::string& problem, const std::string& remedy) const {
    const auto run = run_program(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments << run.output;
    EXPECT_THAT(run.errors, HasSubstr(problem)) << arguments;
    EXPECT_THAT(run.errors, HasSubstr(remedy)) << arguments;
  }

  /// RMS and largest residual of what a model leaves of a campaign, um.
  std::pair<double, double> left(const std::string& campaign, const std::string& model) const {
    const Json compared =
        Json::parse(done("compare " + path(campaign) + "/campaign.toml " + model + " --json"));
    const Json& lengths = compared.at("models").at(0).at("total").at("lengths_um");
    return {lengths.at("rms").get<double>(), lengths.at("max").get<double>()};
  }

 private:
  testing::ScratchFolder folder_;
};

TEST_F(KnownErrors, AMachineIsSimulatedFromAModelAndExplainedByIt) {
  done("simulate " + path("study.toml") + " --errors " + path("known.toml") + " -o " + path("campaign"));
  EXPECT_GT(left("campaign", "nominal").first, 5.0);
  EXPECT_LT(left("campaign", path("known.toml")).second, 0.01);
  write("with-errors.toml", testing::content(path("study.toml")) + "[truth]\nerrors = \"known.toml\"\n");
  done("simulate " + path("with-errors.toml") + " -o " + path("same"));
  for (const auto& entry : std::filesystem::directory_iterator(path("same"))) {
    if (entry.path().extension() != ".csv") continue;
    EXPECT_EQ(testing::content(entry.path()),
              testing::content(path("campaign") + "/" + entry.path().filename().string()));
  }
}

/// The simulator, which evaluates functions and effects by code of its own, holds them as the model does.
TEST_F(KnownErrors, AreHeldBeyondWhatWasMeasured) {
  const std::string known = testing::content(path("known.toml"));
  write("held.toml", known + "[measured]\nX_mm = [-200, 150]\nZ_mm = [-300, -10]\n");
  done("simulate " + path("study.toml") + " --errors " + path("held.toml") + " -o " + path("campaign"));
  EXPECT_LT(left("campaign", path("held.toml")).second, 0.01);
  EXPECT_GT(left("campaign", path("known.toml")).second, 1.0);
  // A folder of tables keeps to what was measured, wherever its rows stand.
  write("rigid.toml", known.substr(0, known.find("[[effects]]")) + "[measured]\nX_mm = [-200, 150]\n");
  done("tables " + path("rigid.toml") + " --format csv --positions 4 -o " + path("tables"));
  EXPECT_THAT(testing::content(path("tables/metadata.csv")), HasSubstr("axis.X.measured_to_mm,150\n"));
  EXPECT_EQ(run_program("tables " + path("tables") + " --at X=149 --no-extrapolation").exit_code, 0);
  refused("tables " + path("tables") + " --at X=151 --no-extrapolation",
          "--at X=151: X at 151 mm lies beyond the readings, -200 to 150 mm",
          "name a point within the readings");
  std::string rows = testing::content(path("tables/error_tables.csv"));
  write("tables/error_tables.csv", rows.replace(rows.find(",mm,"), 4, ",cm,"));
  refused("tables " + path("tables") + " --at X=0", path("tables/error_tables.csv") + ":",
          "positions are in mm");
  write("wrong.toml", known + "[measured]\nX_mm = [150, -200]\n");
  refused("budget " + path("wrong.toml"), "measured.X_mm is not the first and the last position",
          "[FIRST, LAST]");
  write("unsorted.toml", known + "[measured]\nT_column_degC = [24, 21, 19]\n");
  refused("budget " + path("unsorted.toml"),
          "measured.T_column_degC is not the least, mean and greatest value", "[LEAST, MEAN, GREATEST]");
}

TEST_F(KnownErrors, TablesAndResultsAreSimulatedToo) {
  write("rigid.toml",
        testing::content(path("known.toml"))
            .substr(0, testing::content(path("known.toml")).find("[[effects]]\nkind = \"axis-coupling\"")));
  done("tables " + path("rigid.toml") + " --format csv --positions 401 -o " + path("tables"));
  done("simulate " + path("study.toml") + " --errors " + path("tables") + " -o " + path("from-tables"));
  EXPECT_LT(left("from-tables", path("tables")).second, 0.01);
  EXPECT_LT(left("from-tables", path("rigid.toml")).second, 0.05) << "tables are linear between their rows";
  done("align " + path("rigid.toml") + " --primary Y --secondary X -o " + path("aligned"));
  write("aligned.toml",
        "format = \"volcal-study-1\"\nmachine = \"aligned/machine.toml\"\n" + std::string(kMeasured));
  done("simulate " + path("aligned.toml") + " --errors " + path("aligned") + " -o " + path("from-result"));
  EXPECT_LT(left("from-result", path("aligned/identified.toml")).second, 0.01);
}

// The error of the volume is the same in any frame but for a rigid motion, whatever the errors are read from.
TEST_F(KnownErrors, AModelIsAlignedAsAResultIs) {
  done("align " + path("known.toml") + " --primary Y --secondary X -o " + path("aligned"));
  const auto rms = [&](const std::string& errors) {
    return Json::parse(done("budget " + errors + " --json")).at("total").at("rms_um").get<double>();
  };
  EXPECT_NEAR(rms(path("known.toml")), rms(path("aligned")), 0.01);
  EXPECT_NEAR(rms(path("known.toml")), rms(path("aligned/identified.toml")), 0.01);
  EXPECT_THAT(testing::content(path("aligned/identified.toml")), HasSubstr("EC0X_urad"));
  EXPECT_THAT(testing::content(path("aligned/identified.toml")), HasSubstr("Stated in"));
}

TEST_F(KnownErrors, AModelIsValidatedOnReadings) {
  done("simulate " + path("study.toml") + " --errors " + path("known.toml") + " -o " + path("campaign"));
  const Json figures =
      Json::parse(done("validate " + path("known.toml") + " " + path("campaign/campaign.toml") + " --json"));
  EXPECT_GT(figures.at("rms_before_um").get<double>(), 5.0);
  EXPECT_LT(figures.at("rms_after_um").get<double>(), 0.01);
}

/// The tool is off by the same at every point of a machine without rotary axes, whatever states it.
TEST_F(KnownErrors, OfToolsActInEveryOutput) {
  const std::string known = testing::content(path("known.toml"));
  const std::string rigid = known.substr(0, known.find("[[effects]]"));
  const std::string of_tool = "[tools.side_x]\noffset_error_um = [40.0, -30.0, 20.0]\n";
  write("rigid.toml", rigid);
  write("tool.toml", rigid + of_tool);
  const auto error_of = [&](const std::string& errors, const std::string& tool) {
    const Json json =
        Json::parse(done("tables " + errors + " --tool " + tool + " --at X=100,Y=50,Z=-150 --json"));
    return json.at("volumetric_errors")[0].at("error_um").get<std::vector<double>>();
  };
  done("tables " + path("tool.toml") + " --positions 401 -o " + path("tables"));
  for (const std::string& errors : {path("tool.toml"), path("tables")}) {
    const auto with = error_of(errors, "side_x"), without = error_of(path("rigid.toml"), "side_x");
    EXPECT_NEAR(with[0] - without[0], 40.0, 0.05) << errors;
    EXPECT_NEAR(with[1] - without[1], -30.0, 0.05) << errors;
    EXPECT_NEAR(with[2] - without[2], 20.0, 0.05) << errors;
    EXPECT_NEAR(error_of(errors, "short")[0], error_of(path("rigid.toml"), "short")[0], 0.05) << errors;
  }
  const Json causes = Json::parse(done("budget " + path("tool.toml") + " --tool side_x --json")).at("causes");
  EXPECT_TRUE(std::ranges::any_of(causes, [](const Json& cause) { return cause.at("name") == "tool"; }));
  write("two-tools.toml", testing::content(path("study.toml")) +
                              "stations = [{ name = \"P1\", position_mm = [-700, -500, -600] }]\n"
                              "runs = [{ station = \"P1\", tool = \"short\" }, "
                              "{ station = \"P1\", tool = \"side_x\" }]\n");
  done("simulate " + path("two-tools.toml") + " --errors " + path("tool.toml") + " -o " + path("campaign"));
  EXPECT_LT(left("campaign", path("tool.toml")).second, 0.05);
  EXPECT_GT(left("campaign", path("rigid.toml")).second, 5.0);
  const auto rms_after = [&](const std::string& model) {
    return Json::parse(done("validate " + path(model) + " " + path("campaign/campaign.toml") + " --json"))
        .at("rms_after_um")
        .get<double>();
  };
  EXPECT_LT(rms_after("tool.toml"), 0.02);
  EXPECT_GT(rms_after("rigid.toml"), 3.0);
}

TEST_F(KnownErrors, WhatMakesNoSenseIsRefusedWithARemedy) {
  write("empty.toml", "format = \"volcal-model-1\"\nmachine = \"" + testing::kDemoMachine + "\"\n");
  refused("budget " + path("empty.toml"), "states no error", "--tolerances");
  const std::string load = "[[effects]]\nkind = \"reversal\"\nsymbol = \"EYX\"\n";
  write("forgotten.toml", testing::content(path("known.toml")) + load);
  const std::string root = "[[effects]]\nkind = \"custom\"\ntarget = \"EYX\"\namplitude_um = 1.0\n";
  write("root.toml", testing::content(path("known.toml")) + root + "expression = \"sqrt(x - 1e4)\"\n");
  for (const std::string command : {"budget ", "tables --dry-run "})
    refused(command + path("forgotten.toml"), "reversal\": it states no amplitude", "add amplitude_um");
  for (const auto& [model, problem] : {std::pair{"forgotten.toml", "it states no amplitude"},
                                       std::pair{"root.toml", "is not finite at a pose"}})
    refused("simulate " + path("study.toml") + " --errors " + path(model) + " -o " + path("c"), problem, "");
  write("other.toml",
        testing::content(path("known.toml")) +
            "[[effects]]\nkind = \"dead-path\"\nsetup = \"P9_short\"\namplitude_um_per_h = 1.0\n");
  refused("simulate " + path("study.toml") + " --errors " + path("other.toml") + " -o " + path("c"),
          "there is no setup \"P9_short\"", "a name that the campaign will have");
  write("cold.toml", "format = \"volcal-study-1\"\nmachine = \"" + testing::kDemoMachine +
                         "\"\n[[measurements]]\nkind = \"point-grid\"\n");
  refused("simulate " + path("cold.toml") + " --errors " + path("known.toml") + " -o " + path("c"), "air",
          "[[temperatures]]");
  refused("simulate " + path("study.toml") + " --errors " + kExercises + "slideway.toml -o " + path("c"),
          "another machine", "name the machine");
  write("both.toml", testing::content(path("study.toml")) +
                         "[truth]\nerrors = \"known.toml\"\nvolumetric_rms_um = [1, 2]\n");
  refused("simulate " + path("both.toml") + " -o " + path("c"), "volumetric_rms_um", "keep one of the two");
  done("align " + path("known.toml") + " --primary Y --secondary X -o " + path("aligned"));
  refused("plan " + path("aligned/machine.toml") + " --readings 64 --model " + path("aligned"),
          "is a result, a model file is expected", "identified.toml");
}

TEST_F(KnownErrors, ABudgetOfTolerancesIsOneCommand) {
  write("tolerances.toml",
        "format = \"volcal-tolerances-1\"\n[tolerances]\npositioning_um = 10\nstraightness_um = 8\n"
        "angles_urad = 15\nsquareness_urad = 20\n");
  const std::string command = "budget " + testing::kDemoMachine + " --tolerances " + path("tolerances.toml");
  const Json budget = Json::parse(done(command + " --tool side_y --json"));
  EXPECT_EQ(budget.at("tool"), "side_y");
  double share = 0.0;
  for (const Json& cause : budget.at("causes")) share += cause.at("expected_share_percent").get<double>();
  EXPECT_NEAR(share, 100.0, 0.01);
  EXPECT_EQ(budget.at("contributions").size(), 21U);
  EXPECT_GT(budget.at("rms_95_um").get<double>(), budget.at("total").at("expected_rms_um").get<double>());
  EXPECT_TRUE(budget.at("without_tolerance").empty());
  write("tolerances.toml", "format = \"volcal-tolerances-1\"\n[tolerances]\nEXX_um = 10\n");
  EXPECT_THAT(done(command), HasSubstr("without a tolerance, counted as free of error: EYX, EZX"));
  write("model.toml", "format = \"volcal-model-1\"\nmachine = \"" + testing::kDemoMachine + "\"\n");
  EXPECT_EQ(done("budget " + path("model.toml") + " --tolerances " + path("tolerances.toml")), done(command));
  refused("budget " + path("known.toml") + " --tolerances " + path("tolerances.toml"), "states errors",
          "machine file");
}

/// How often a text stands in another.
int count_of(const std::string& wanted, const std::string& text) {
  int count = 0;
  for (auto at = text.find(wanted); at != std::string::npos; at = text.find(wanted, at + 1)) ++count;
  return count;
}

/// metadata.csv without what error tables say of effects, as older versions wrote it.
std::string without_effect_keys(const std::string& metadata) {
  std::string kept;
  std::istringstream lines(metadata);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("effects.")) kept += line + "\n";
  }
  return kept;
}

TEST_F(KnownErrors, TablesSayWhichToolAndConditionsTheyHoldFor) {
  done("tables " + path("known.toml") + " --tool side_x --conditions T_air=23 -o " + path("tables"));
  const std::string said = "these errors are those of tables for tool side_x, T_air 23 degC; for ",
                    other_tool = "the tables were made for tool side_x: for tool short ";
  const auto said_once = [&](const std::string& arguments) {
    const std::string output = done(arguments);
    EXPECT_EQ(count_of(said, output), 1) << arguments << "\n" << output;
    return output;
  };
  EXPECT_THAT(said_once("tables " + path("tables") + " --at X=0 --tool side_x"), Not(HasSubstr(other_tool)));
  EXPECT_THAT(said_once("tables " + path("tables") + " --at X=0 --tool short"), HasSubstr(other_tool));
  EXPECT_THAT(said_once("tables " + path("tables") + " --at X=0 --conditions T_air=20"),
              HasSubstr("the tables hold for T_air = 23 degC: T_air = 20 degC changes nothing in them"));
  EXPECT_THAT(said_once("budget " + path("tables") + " --tool short"), HasSubstr(other_tool));
  said_once("tables " + path("tables") + " --tool side_x -o " + path("again"));
  said_once("tables " + path("again") + " --at X=0 --tool side_x");
  said_once("simulate " + path("study.toml") + " --errors " + path("tables") + " -o " + path("campaign"));
  const std::string campaign = " " + path("campaign/campaign.toml");
  said_once("validate " + path("tables") + campaign);
  said_once("compare" + campaign + " " + path("tables"));
  write("program.ngc", "G21 G90 G94\nF1000\nG0 X0 Y0 Z0\nG1 X50\nM2\n");
  const auto rewritten = [&](const std::string& output) {
    return "compensate " + path("tables") + " " + path("program.ngc") + " -o " + path(output) +
           " --work-offset G54=X0,Y0,Z-100";
  };
  EXPECT_THAT(said_once(rewritten("out.ngc")), Not(HasSubstr(other_tool))) << "their tool is the default";
  EXPECT_THAT(said_once(rewritten("short.ngc") + " --tool short"), HasSubstr(other_tool));
  const Json json = Json::parse(done("budget " + path("tables") + " --tool short --json"));
  EXPECT_EQ(json.at("of_tables_findings").at(0).at("code"), "errors.of-tables");
  EXPECT_EQ(json.at("of_tables_findings").at(1).at("code"), "errors.tables-of-other-tool");
}

// The functional point is the spindle reference: what a tool without an offset has.
TEST_F(KnownErrors, AMachineWithoutToolsHasTablesAtTheSpindleReference) {
  const std::string demo = testing::content(testing::kDemoMachine);
  const std::string machine = demo.substr(0, demo.find("[tools."));
  write("bare.toml", machine);
  write("equipped.toml", machine + "[tools.none]\noffset_mm = [0.0, 0.0, 0.0]\n");
  for (const std::string name : {"bare", "equipped"})
    write("errors_" + name + ".toml",
          "format = \"volcal-model-1\"\nmachine = \"" + name + ".toml\"\n" + kKnown);
  const auto errors_at = [&](const std::string& errors) {
    return Json::parse(done("tables " + path(errors) + " --at X=120,Y=40,Z=-110 --json"))
        .at("volumetric_errors");
  };
  const Json bare = errors_at("errors_bare.toml"), equipped = errors_at("errors_equipped.toml");
  ASSERT_EQ(bare.size(), 1U);
  EXPECT_EQ(bare.at(0).at("tool"), "");
  EXPECT_EQ(bare.at(0).at("error_um"), equipped.at(0).at("error_um"));
  for (const std::string name : {"bare", "equipped"})
    done("tables " + path("errors_" + name + ".toml") + " --grid 3 -o " + path("tables_" + name));
  EXPECT_EQ(errors_at("tables_bare").at(0).at("error_um"), errors_at("tables_equipped").at(0).at("error_um"));
  const auto grid = [&](const std::string& folder) {
    return testing::content(path(folder + "/volumetric_grid.csv"));
  };
  EXPECT_EQ(std::ranges::count(grid("tables_bare"), '\n'), 1 + 3 * 3 * 3);
  EXPECT_EQ(std::ranges::count(grid("tables_equipped"), '\n'), 1 + 3 * 3 * 3);
}

TEST_F(KnownErrors, EveryToolThatIsPrintedIsSaidToBeOfOtherTables) {
  done("tables " + path("known.toml") + " --tool side_x --conditions T_air=23 -o " + path("tables"));
  const std::string all = done("tables " + path("tables") + " --at X=0");
  const std::string one = done("tables " + path("tables") + " --at X=0 --tool short");
  const std::string other_tool = "the tables were made for tool side_x: for tool short ";
  EXPECT_THAT(one, HasSubstr(other_tool));
  EXPECT_THAT(all, HasSubstr(other_tool));
  EXPECT_THAT(all, Not(HasSubstr("for tool side_x they lack")));
  EXPECT_THAT(done("tables " + path("tables") + " --at X=0 --dry-run"), HasSubstr(other_tool));
}

TEST_F(KnownErrors, TablesOfOlderMakeAreReadAsBefore) {
  done("tables " + path("known.toml") + " --tool side_x --conditions T_air=23 -o " + path("tables"));
  const std::string at = "tables " + path("tables") + " --at X=120,Y=40,Z=-110 --json";
  const Json now = Json::parse(done(at)).at("volumetric_errors");
  write("tables/metadata.csv", without_effect_keys(testing::content(path("tables/metadata.csv"))));
  const Json before = Json::parse(done(at));
  EXPECT_EQ(before.at("volumetric_errors"), now);
  EXPECT_TRUE(before.at("of_tables").empty());
}

TEST_F(KnownErrors, EffectsAlongAPathAreSaidToBeInNoFigure) {
  write("path.toml", "format = \"volcal-model-1\"\nmachine = \"" + testing::kDemoMachine +
                         "\"\n[functions]\nEXX = { basis = \"legendre\", degree = 1, coefficients_um = [1.0, "
                         "4.0] }\n[[effects]]\nkind = \"following-error\"\naxis = \"X\"\nby = "
                         "\"feed\"\namplitude_ms = 0.3\n");
  for (const std::string& command :
       {"tables " + path("path.toml") + " --at X=100", "budget " + path("path.toml")}) {
    const std::string output = done(command + " --conditions feed_mm_min=3000");
    EXPECT_THAT(output, HasSubstr("was identified but is in none of these figures: it acts along a path"));
    EXPECT_THAT(output, HasSubstr("! feed drives "));
    EXPECT_THAT(output, Not(HasSubstr("no identified error depends on feed")));
  }
}

TEST_F(KnownErrors, ConditionsWithoutACampaignAreAssumed) {
  write("warm.toml", "format = \"volcal-model-1\"\nmachine = \"" + testing::kDemoMachine +
                         "\"\n[[effects]]\nkind = \"thermal-drift\"\nsymbol = \"EXX\"\ntemperature = "
                         "\"air\"\namplitude_um_per_K = 4.0\n");
  EXPECT_THAT(done("tables " + path("warm.toml") + " --at X=100"),
              HasSubstr("Stated for T_air 20 degC (assumed)\n"));
  const Json json = Json::parse(done("tables " + path("warm.toml") + " --at X=100 --json"));
  EXPECT_EQ(json.at("conditions").at("T_air_degC").at("origin"), "assumed");
  done("tables " + path("warm.toml") + " -o " + path("tables"));
  const std::string metadata = testing::content(path("tables/metadata.csv"));
  EXPECT_THAT(metadata, HasSubstr("conditions.T_air_degC.is,assumed\n"));
  EXPECT_THAT(metadata, HasSubstr("conditions.time_s.is,assumed\n"));
  EXPECT_THAT(metadata, HasSubstr("reference_temperature_is,assumed\n"));
  EXPECT_THAT(metadata, Not(HasSubstr("mean of the campaign")));
}

// With a dense covariance these would take gigabytes.
TEST_F(KnownErrors, TablesOfManyPositionsAreRead) {
  const std::string rigid = testing::content(path("known.toml"));
  write("rigid.toml", rigid.substr(0, rigid.find("[[effects]]\nkind = \"axis-coupling\"")));
  done("tables " + path("rigid.toml") + " --positions 2001 --grid 2 -o " + path("tables"));
  const auto at = [&](const std::string& errors) {
    return Json::parse(done("tables " + path(errors) + " --at X=120,Y=40,Z=-110 --tool side_x --json"))
        .at("volumetric_errors")
        .at(0)
        .at("error_um");
  };
  const Json model = at("rigid.toml"), tables = at("tables");
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(tables.at(k).get<double>(), model.at(k).get<double>(), 1e-3);
}

TEST_F(KnownErrors, GridsHaveABound) {
  refused("tables " + path("known.toml") + " --grid 301 -o " + path("tables"), "million points",
          "ten million points are the most");
}

TEST_F(KnownErrors, TablesRefuseOptionsThatSayNothing) {
  const std::string known = "tables " + path("known.toml") + " --conditions T_air=20 ";
  refused(known + "--dry-run --format linuxcnc --positions 5", "--positions shapes the tables of csv",
          "--format csv");
  refused(known + "--dry-run --format linuxcnc --grid 3", "--grid shapes the tables of csv", "--format csv");
  refused(known + "--dry-run --format neutral-csv --zero plus", "--zero shapes the tables of csv",
          "--format csv");
  refused(known + "--dry-run --approach X+", "there is none", "--at X=100");
  refused(known + "--at X=100 --approach X+,Y-,X-", "names X twice", "one direction");
  const auto both = run_program(known + "--dry-run --positions 5 --step 10");
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.errors, HasSubstr("--step"));
}

TEST_F(KnownErrors, ExportTakesResults) {
  refused("export " + path("known.toml") + " --npz " + path("a.npz"), "export takes result folders",
          "result.json");
}

TEST_F(KnownErrors, AnUnknownKeyOfAFunctionIsNamedBeforeTheNumberOfItsCoefficients) {
  write("unknown.toml", "format = \"volcal-model-1\"\nmachine = \"" + testing::kDemoMachine +
                            "\"\n[functions]\nEXX = { basis = \"legendre\", harmonics = 2, coefficients_um = "
                            "[1.0, 2.0, 3.0, 4.0, 5.0, 6.0] }\n");
  refused("budget " + path("unknown.toml"), "unknown key functions.EXX.harmonics", "keys here");
}

}  // namespace
}  // namespace volcal
