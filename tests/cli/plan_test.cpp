/// volcal plan as a user runs it: files, a round trip by simulation and fit, what is refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"
#include "volcal/identify/io/campaign/campaign_reader.h"

namespace volcal {
namespace {

using testing::content;
using ::testing::HasSubstr;
using testing::run_program;

const std::string kMachine = std::string(VOLCAL_SOURCE_DIR) + "/datasets/demo/machine.toml";

nlohmann::json json_of(const std::filesystem::path& file) { return nlohmann::json::parse(content(file)); }

std::string model_of_two_pieces(const std::filesystem::path& folder) {
  std::string path = (folder / "model.toml").string();
  std::ofstream(path) << "format = \"volcal-model-1\"\nmachine = \"" << kMachine
                      << "\"\n[functions]\ndefault = { basis = \"bspline\", degree = 3, knots = 2 }\n";
  return path;
}

/// The files are measured by `simulate`, and the fit states what the plan predicted, within what 320 readings
/// tell of the noise.
TEST(Plan, IsSimulatedAndFitted) {
  const testing::ScratchFolder scratch;
  const std::string plan = (scratch.path() / "plan").string(), model = model_of_two_pieces(scratch.path());
  const auto planned = run_program("plan " + kMachine + " --model " + model + " --readings 320 -o " + plan);
  ASSERT_EQ(planned.exit_code, 0) << planned.errors;
  EXPECT_THAT(planned.output, HasSubstr("Against the textbook layout: volumetric uncertainty"));
  for (const char* file : {"plan.json", "plan.txt", "study.toml", "machine.toml", "campaign/campaign.toml"})
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(plan) / file)) << file;
  const nlohmann::json json = json_of(std::filesystem::path(plan) / "plan.json");
  EXPECT_EQ(json["format"], "volcal-plan-1");
  EXPECT_EQ(json["campaigns"][0]["readings"], 320);
  EXPECT_EQ(json["campaigns"][0]["errors"].size(), 21U);
  EXPECT_FALSE(json["campaigns"][0]["effects"].empty());

  const std::string measured = (scratch.path() / "measured").string();
  const std::string result = (scratch.path() / "result").string();
  const auto simulated = run_program("simulate " + plan + "/study.toml -o " + measured);
  ASSERT_EQ(simulated.exit_code, 0) << simulated.errors;
  EXPECT_THAT(simulated.output, HasSubstr("320 readings"));
  // What the random machine has beyond two pieces inflates the noise of the fit; u follows it.
  const auto fitted =
      run_program("fit " + measured + "/campaign.toml --model " + model + " --noise white -o " + result);
  ASSERT_EQ(fitted.exit_code, 0) << fitted.errors;
  const auto with = run_program("plan " + kMachine + " --model " + model + " --readings 320 --with " +
                                measured + "/campaign.toml --json");
  ASSERT_EQ(with.exit_code, 0) << with.errors;
  const nlohmann::json compared = nlohmann::json::parse(with.output);
  ASSERT_EQ(compared["campaigns"].size(), 3U);
  EXPECT_NEAR(compared["campaigns"][2]["u_volumetric_rms_um"].get<double>() /
                  compared["campaigns"][0]["u_volumetric_rms_um"].get<double>(),
              1.0, 0.05);  // the same positions; stations are guessed 5 mm off
}

/// Root mean square of u over the errors of one kind, in um or urad; `errors`: of a plan or of a result, with
/// the factor to the micro unit.
double mean_u(const nlohmann::json& errors, const char* key, double micro, bool rotations) {
  double squares = 0.0, count = 0.0;
  for (const nlohmann::json& error : errors) {
    const bool is_rotation =
        std::string("ABC").find(error["symbol"].get<std::string>()[1]) != std::string::npos;
    if (is_rotation != rotations) continue;
    squares += std::pow(error[key].get<double>() * micro, 2);
    count += 1.0;
  }
  return std::sqrt(squares / count);
}

/// Circles of a ball-bar with three tools about three places; the simulated machine has no errors, so that
/// the fit finds the noise that the plan assumed.
TEST(Plan, OfABallBarIsSimulatedAndFitted) {
  const testing::ScratchFolder scratch;
  const std::string plan = (scratch.path() / "plan").string(),
                    model = (scratch.path() / "model.toml").string();
  std::ofstream(model) << "format = \"volcal-model-1\"\nmachine = \"" << kMachine
                       << "\"\n[functions]\ndefault = { basis = \"legendre\", degree = 2 }\n";
  const auto planned = run_program("plan " + kMachine + " --model " + model +
                                   " --instrument ball-bar --bar-mm 150 --bar-sigma-um 0.5 --stations 3"
                                   " --readings 1200 -o " +
                                   plan);
  ASSERT_EQ(planned.exit_code, 0) << planned.output << planned.errors;
  EXPECT_THAT(planned.output, HasSubstr("budget: 3 places of ball-bar 150 mm, u 0.5 um, 1,200 readings"));
  EXPECT_THAT(planned.output, HasSubstr("Places of the centre ball, workpiece coordinates"));
  const nlohmann::json json = json_of(std::filesystem::path(plan) / "plan.json");
  const nlohmann::json& expected = json["campaigns"][0];
  EXPECT_LE(expected["readings"], 1200);
  EXPECT_TRUE(expected["not_visible"].empty());
  std::ofstream(plan + "/study.toml", std::ios::app) << "\n[truth]\nkind = \"perfect\"\n";

  const std::string measured = (scratch.path() / "measured").string();
  const auto simulated = run_program("simulate " + plan + "/study.toml -o " + measured);
  ASSERT_EQ(simulated.exit_code, 0) << simulated.errors;
  EXPECT_THAT(simulated.output, HasSubstr(std::to_string(expected["readings"].get<int>()) + " readings in " +
                                          std::to_string(expected["setups"].get<int>()) + " setups"));
  const std::string result = (scratch.path() / "result").string();
  const auto fitted =
      run_program("fit " + measured + "/campaign.toml --model " + model + " --noise white -o " + result);
  ASSERT_EQ(fitted.exit_code, 0) << fitted.output << fitted.errors;
  const nlohmann::json fit = json_of(std::filesystem::path(result) / "result.json");
  for (const bool rotations : {false, true}) {
    EXPECT_NEAR(mean_u(fit["rank"]["errors"], "u_rms", 1e6, rotations) /
                    mean_u(expected["errors"], "u", 1.0, rotations),
                1.0, 0.1)
        << (rotations ? "rotations" : "displacements");
  }
}

TEST(Plan, OfABallBarNamesWhatItCannotSee) {
  const testing::ScratchFolder scratch;
  const std::string model = model_of_two_pieces(scratch.path());
  const auto planned = run_program("plan " + kMachine + " --model " + model +
                                   " --instrument ball-bar --bar-mm 100 --stations 1 --tools short"
                                   " --readings 300");
  EXPECT_EQ(planned.exit_code, 1) << planned.errors;
  EXPECT_THAT(planned.output, HasSubstr("What this budget cannot determine"));
  EXPECT_THAT(planned.output, HasSubstr("a further place at ["));
  EXPECT_THAT(planned.output, HasSubstr("tool side_y at P1"));
}

TEST(Plan, RefusesOptionsOfOtherInstruments) {
  const auto refused = [](const std::string& arguments, const std::string& words) {
    const auto run = run_program("plan " + kMachine + " --readings 400 " + arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_THAT(run.errors, HasSubstr(words)) << arguments;
  };
  refused("--bar-mm 100", "--bar-mm does not apply to a laser-tracer");
  refused("--instrument laser-tracker --bar-sigma-um 1", "--bar-sigma-um does not apply to a laser-tracker");
  refused("--instrument ball-bar --bar-mm 100 --range-mm 1,2", "--range-mm does not apply to a ball-bar");
  refused("--instrument ball-bar --bar-mm 100 --clearance-mm 5",
          "--clearance-mm does not apply to a ball-bar");
  refused("--instrument ball-bar", "length of the ball-bar is missing");
  refused("--instrument ball-bar --bar-mm 2000", "give a shorter --bar-mm");
  refused("--instrument ball-bar --bar-mm -1", "--bar-mm");
  refused("--instrument ball-bar --bar-mm 100 --stations 12", "fewer --stations");
}

TEST(Plan, RefusesBadInput) {
  const auto refused = [](const std::string& arguments, const std::string& words) {
    const auto run = run_program("plan " + arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_THAT(run.errors, HasSubstr(words)) << arguments;
  };
  refused(kMachine, "neither readings nor time are limited");
  refused(kMachine + " --readings 100 --tools longest", "no tool longest");
  refused(kMachine + " --readings 100 --tool-count 9", "more tools than there are");
  refused(kMachine + " --readings 100 --tools short,side_x,short", "--tools names short twice");
  refused(kMachine + " --readings 100 --noise 0,0,0",
          "--noise: the standard deviation of the readings is zero");
  refused(kMachine + " --readings 100 --minimise EXQ", "is not an error of this machine");
  refused(kMachine + " --readings 100 --minimise separate:reversal:EXX", "cannot be separated");
  refused(kMachine + " --readings 100 --minimise separate:reversal:EXX,nonsense:Y", "not a kind of effect");
  refused(kMachine +
              " --readings 100 --minimise 'separate:dead-path:readings of P1_short,"
              "dead-path:readings of P1_short'",
          "names dead-path:readings of P1_short:");
  refused(kMachine + " --readings 100 --extend", "nothing to extend");
  refused(kMachine + " --readings 100 --range-mm 900,300", "not the smaller one");
  refused(kMachine + " --readings 100 --region-mm 500,100,0,1,0,1", "above its upper one");
  refused(kMachine + " --readings 100 --region-mm 0,10,0,10,-300,-290", "nowhere");
  refused(kMachine + " --readings 3", "--readings");
  refused(kMachine + " --time 0.01", "do not suffice for one run at every station");
  refused(kMachine + " --readings 100 --range-mm 10,20", "no station sees the positions");
  refused(kMachine + " --readings 100 --spindle-mm 5000", "no station sees the positions");
  refused(kMachine + " --readings 100 --elevation-deg 84,85", "no station sees the positions");
  refused("nowhere.toml --readings 100", "nowhere.toml");
}

/// mixed-1 of the examples, with its machine file rewritten in a folder.
class PlanOfAnotherMachineFile : public ::testing::Test {
 protected:
  std::string machine_with(const std::string& before, const std::string& after) const {
    std::string text = content(example("machine.toml"));
    const std::size_t at = text.find(before);
    EXPECT_NE(at, std::string::npos) << before;
    text.replace(at, before.size(), after);
    std::string file = (scratch_.path() / "machine.toml").string();
    std::ofstream(file) << text;
    return file;
  }

  static std::string example(const std::string& name) {
    return std::string(VOLCAL_SOURCE_DIR) + "/datasets/examples/mixed-1/" + name;
  }

  static void expect_refused(const std::string& machine, const std::string& words) {
    for (const char* option : {"--with ", "--extend --with ", "--verify "}) {
      const auto run =
          run_program("plan " + machine + " --readings 100 " + option + example("campaign.toml"));
      EXPECT_EQ(run.exit_code, 2) << option << run.output;
      EXPECT_THAT(run.errors, HasSubstr(words)) << option;
      EXPECT_THAT(run.errors, HasSubstr("give the machine file of the campaign, ")) << option;
    }
  }

  testing::ScratchFolder scratch_;
};

TEST_F(PlanOfAnotherMachineFile, IsRefused) {
  const std::string other = "the campaign's machine is not the one that is given: ";
  expect_refused(machine_with("w X' Y' b Z t", "w X' b Y Z t"), other + "structure");
  expect_refused(machine_with("reference_point_mm = [0.0, 0.0, 0.0]", "reference_point_mm = [9.0, 0.0, 0.0]"),
                 other + "reference point of X");
  expect_refused(machine_with("[tools.side_y]\noffset_mm = [-20.0, 130.0, -280.0]", ""),
                 "the machine that is given has no tool side_y");
  expect_refused(
      machine_with("[110.0, 15.0, -240.0]", "[111.0, 15.0, -240.0]"),
      "the tool side_x has the offset [110, 15, -240] mm, on the machine that is given [111, 15, -240] mm");
}

/// Displacements whose direction follows from their positions; tools in another order are the same tools.
TEST_F(PlanOfAnotherMachineFile, ExtendsDirectTestsWithTheirTools) {
  const std::string machine = machine_with("[tools.short]\noffset_mm = [0.0, 0.0, -150.0]\n", "");
  std::ofstream(machine, std::ios::app) << "\n[tools.short]\noffset_mm = [0.0, 0.0, -150.0]\n";
  const std::string model = (scratch_.path() / "model.toml").string(),
                    plan = (scratch_.path() / "plan").string();
  std::ofstream(model) << "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n[functions]\n"
                          "default = { basis = \"legendre\", degree = 2 }\n";
  const auto run = run_program("plan " + machine + " --model " + model + " --with " +
                               example("campaign.toml") + " --extend --stations 1 --readings 40 -o " + plan);
  ASSERT_EQ(run.exit_code, 0) << run.output << run.errors;
  const Campaign before = read_campaign(example("campaign.toml"));
  const Campaign after = read_campaign(plan + "/campaign/campaign.toml");
  ASSERT_EQ(after.setups.size(), before.setups.size() + 1);
  for (std::size_t i = 0; i < before.setups.size(); ++i) {
    EXPECT_EQ(after.setups[i].name, before.setups[i].name);
    EXPECT_EQ(after.machine.tools[after.setups[i].tool].name,
              before.machine.tools[before.setups[i].tool].name);
  }
}

TEST(Plan, PointsOfARunAreReadWithTheirErrors) {
  const testing::ScratchFolder scratch;
  const auto study = [&](const std::string& points) {
    std::ofstream(scratch.path() / "points.csv") << points;
    std::ofstream(scratch.path() / "study.toml")
        << "format = \"volcal-study-1\"\nmachine = \"" << kMachine
        << "\"\n[[measurements]]\nkind = \"laser-tracer\"\n[[measurements.stations]]\nname = \"P1\"\n"
           "position_mm = [-600.0, 0.0, -400.0]\n[[measurements.runs]]\nstation = \"P1\"\ntool = \"short\"\n"
           "points = \"points.csv\"\n";
    return run_program("simulate " + (scratch.path() / "study.toml").string() + " -o " +
                       (scratch.path() / "out").string());
  };
  EXPECT_THAT(study("x_mm,y_mm,z_mm,dir_x\n0,0,-100,1\n10,20,-30,-1\n").output, HasSubstr("2 readings"));
  EXPECT_THAT(study("x_mm,y_mm\n0,0\n").errors, HasSubstr("column z_mm is missing"));
  EXPECT_THAT(study("x_mm,y_mm,z_mm,dir_x\n0,0,0,3\n").errors, HasSubstr("points.csv:2"));
}

}  // namespace
}  // namespace volcal
