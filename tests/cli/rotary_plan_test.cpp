/// Plans of instruments that read while rotary axes turn, as a user makes them: files, a rehearsal by
/// simulation and fit, what a budget cannot determine, what is refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;
using testing::run_program;

const char* const kCradle =
    "format = \"volcal-machine-1\"\nname = \"cradle\"\nstructure = \"w C' A' b X Y Z t\"\n"
    "[axes.X]\ntravel_mm = [-500.0, 500.0]\nhome_mm = 0.0\n[axes.Y]\ntravel_mm = [-500.0, 500.0]\nhome_mm = "
    "0.0\n"
    "[axes.Z]\ntravel_mm = [-500.0, 500.0]\nhome_mm = 0.0\n"
    "[axes.A]\ntravel_deg = [-120.0, 120.0]\nhome_deg = 0.0\ncentre_mm = [0.0, 0.0, 0.0]\n"
    "[axes.C]\ntravel_deg = [-180.0, 180.0]\nhome_deg = 0.0\ncentre_mm = [0.0, 0.0, 0.0]\n"
    "[tools.t]\noffset_mm = [0.0, 0.0, -200.0]\n";
const char* const kThreeAxes =
    "format = \"volcal-machine-1\"\nname = \"three axes\"\nstructure = \"w b X Y Z t\"\n"
    "[axes.X]\ntravel_mm = [-500.0, 500.0]\nhome_mm = 0.0\n[axes.Y]\ntravel_mm = [-500.0, 500.0]\nhome_mm = "
    "0.0\n"
    "[axes.Z]\ntravel_mm = [-500.0, 500.0]\nhome_mm = 0.0\n[tools.t]\noffset_mm = [0.0, 0.0, -200.0]\n";
/// Errors that one place and one tool tell.
const char* const kFewErrors =
    "format = \"volcal-model-1\"\nmachine = \"cradle.toml\"\n[functions]\ndefault = { basis = \"zero\" }\n"
    "EYC = { basis = \"fourier\", degree = 1 }\nECC = { basis = \"fourier\", degree = 1 }\n"
    "ECA = { basis = \"fourier\", degree = 1 }\n[locations]\nEC0Y = \"zero\"\nEA0Z = \"zero\"\nEB0Z = "
    "\"zero\"\n";

class RotaryPlanProgram : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = std::make_unique<testing::ScratchFolder>();
    write("cradle.toml", kCradle);
    write("three.toml", kThreeAxes);
    write("few.toml", kFewErrors);
  }
  static void TearDownTestSuite() { scratch_.reset(); }

  static std::string path(const std::string& name) { return (scratch_->path() / name).string(); }
  static void write(const std::string& name, const std::string& text) {
    std::ofstream(scratch_->path() / name, std::ios::binary) << text;
  }
  static Json json_of(const std::string& name) {
    return Json::parse(testing::content(scratch_->path() / name));
  }

  static testing::ProgramRun plan(const std::string& arguments, const std::string& machine = "cradle.toml") {
    return run_program("plan " + path(machine) + " --threads 1 --instrument " + arguments);
  }

  /// Plans, rehearses on a machine without errors and fits: what the fit states is what the plan predicted.
  static void rehearse(const std::string& arguments, const std::string& folder) {
    const auto planned = plan(arguments + " --model " + path("few.toml") + " -o " + path(folder));
    ASSERT_EQ(planned.exit_code, 0) << planned.output << planned.errors;
    EXPECT_THAT(planned.output, HasSubstr("next: volcal simulate " + path(folder) + "/study.toml"));
    const Json expected = json_of(folder + "/plan.json").at("campaigns").at(0);
    EXPECT_TRUE(expected.at("not_visible").empty());
    std::ofstream(path(folder) + "/study.toml", std::ios::app) << "\n[truth]\nkind = \"perfect\"\n";
    const auto simulated =
        run_program("simulate " + path(folder) + "/study.toml -o " + path(folder + "-measured"));
    ASSERT_EQ(simulated.exit_code, 0) << simulated.errors;
    EXPECT_THAT(simulated.output,
                HasSubstr(std::to_string(expected.at("readings").get<int>()) + " readings"));
    const auto fitted =
        run_program("fit " + path(folder + "-measured") + "/campaign.toml --model " + path("few.toml") +
                    " --keep-stated-sigma --threads 1 -o " + path(folder + "-result"));
    ASSERT_EQ(fitted.exit_code, 0) << fitted.output << fitted.errors;
    const Json errors = json_of(folder + "-result/result.json").at("rank").at("errors");
    ASSERT_EQ(errors.size(), expected.at("errors").size());
    for (std::size_t i = 0; i < errors.size(); ++i) {
      EXPECT_EQ(errors[i].at("symbol"), expected.at("errors")[i].at("symbol"));
      EXPECT_NEAR(1e6 * errors[i].at("u_rms").get<double>() / expected.at("errors")[i].at("u").get<double>(),
                  1.0, 0.2)
          << errors[i].at("symbol");
    }
  }

  static std::unique_ptr<testing::ScratchFolder> scratch_;
};
std::unique_ptr<testing::ScratchFolder> RotaryPlanProgram::scratch_;

TEST_F(RotaryPlanProgram, OfABallBarIsRehearsed) {
  rehearse("ball-bar-rotary --bar-mm 100 --bar-sigma-um 0.5 --stations 1 --readings 400", "bar");
  EXPECT_THAT(testing::content(path("bar/plan.txt")),
              HasSubstr("budget: 1 places of ball-bar-rotary 100 mm, u 0.5 um, 400 readings"));
  EXPECT_TRUE(json_of("bar/plan.json").at("layout").at("runs").at(0).contains("path"));
}

TEST_F(RotaryPlanProgram, OfATracerIsRehearsed) {
  rehearse("laser-tracer-rotary --stations 1 --readings 96", "tracer");
  EXPECT_THAT(testing::content(path("tracer/plan.txt")),
              HasSubstr("budget: 1 stations of laser-tracer-rotary, 96 readings"));
}

/// The textbook's even share of a small budget leaves errors open that the search determines.
TEST_F(RotaryPlanProgram, SaysWhatTheTextbookCannotDetermine) {
  const auto run =
      plan("ball-bar-rotary --bar-mm 100 --stations 1 --readings 200 --json --model " + path("few.toml"));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json campaigns = Json::parse(run.output).at("campaigns");
  EXPECT_TRUE(campaigns.at(0).at("not_visible").empty());
  EXPECT_FALSE(campaigns.at(1).at("not_visible").empty());
}

TEST_F(RotaryPlanProgram, Refuses) {
  const auto refused = [](const std::string& arguments, const std::string& words,
                          const std::string& machine = "cradle.toml") {
    const auto run = plan(arguments + " --readings 400", machine);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_THAT(run.errors, HasSubstr(words)) << arguments;
  };
  refused("ball-bar-rotary", "the length of the ball-bar is missing (give --bar-mm");
  refused("ball-bar-rotary --bar-mm 100 --range-mm 1,2", "--range-mm does not apply to a ball-bar-rotary");
  refused("ball-bar-rotary --bar-mm 3000", "no bar keeps its length while the rotary axes turn");
  refused("ball-bar-rotary --bar-mm 100 --stations 12", "fewer --stations");
  refused("ball-bar-rotary --bar-mm 100", "the machine has no rotary axis (plan a ball-bar-rotary for",
          "three.toml");
  refused("laser-tracer-rotary --bar-mm 100", "--bar-mm does not apply to a laser-tracer-rotary");
  refused("laser-tracer-rotary --range-mm 10,20", "no station sees the positions");
  refused("laser-tracer-rotary", "the machine has no rotary axis (plan a laser-tracer-rotary for",
          "three.toml");
}

}  // namespace
}  // namespace volcal
