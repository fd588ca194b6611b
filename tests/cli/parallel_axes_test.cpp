/// A boring mill with a quill W through the program: simulated, fitted, judged, tabulated; what cannot take
/// the axis refuses it and names the remedy.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"

namespace volcal {
namespace {

using ::testing::AllOf;
using testing::content;
using ::testing::HasSubstr;
using testing::run_program;

const char* const kQuillMachine =
    "format = \"volcal-machine-1\"\nstructure = \"w X' b Y Z W t\"\n"
    "[axes.X]\ntravel_mm = [0.0, 1000.0]\nhome_mm = 0.0\n"
    "[axes.Y]\ntravel_mm = [0.0, 800.0]\nhome_mm = 0.0\n"
    "[axes.Z]\ntravel_mm = [-600.0, 0.0]\nhome_mm = 0.0\n"
    "[axes.W]\ntravel_mm = [-400.0, 50.0]\nhome_mm = -50.0\n"
    "[tolerances]\npositioning_um = 10.0\nsquareness_urad = 20.0\nEXW_um = 8.0\n"
    "[tools.short]\noffset_mm = [0.0, 0.0, -150.0]\n"
    "[tools.side]\noffset_mm = [120.0, 0.0, -250.0]\n"
    "[tools.front]\noffset_mm = [0.0, 120.0, -250.0]\n";

const char* const kQuillStudy =
    "format = \"volcal-study-1\"\nmachine = \"machine.toml\"\nseed = 7\n"
    "[truth]\nwave_scale = 0.0\n"
    "[[measurements]]\nkind = \"laser-tracer\"\ngrid = [5, 4, 4]\nparallel = \"random\"\n"
    "[[measurements]]\nname = \"lines\"\nkind = \"axis-lines\"\naxes = [\"W\", \"Z\"]\n"
    "[[measurements]]\nname = \"bar\"\nkind = \"ball-bar-circles\"\nplanes = [\"XW\", \"ZX\"]\nradius_mm = "
    "80.0\n"
    "[validation]\npoints = 40\n";

const char* const kQuillModel =
    "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n"
    "[functions]\ndefault = { basis = \"bspline\", degree = 3, knots = 4 }\n";

class Quill : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = std::make_unique<testing::ScratchFolder>();
    write("machine.toml", kQuillMachine);
    write("study.toml", kQuillStudy);
    write("model.toml", kQuillModel);
    const auto simulated = run_program("simulate " + path("study.toml") + " -o " + path("campaign"));
    ASSERT_EQ(simulated.exit_code, 0) << simulated.errors;
    const auto fitted = run_program("fit " + path("campaign/campaign.toml") + " --model " +
                                    path("model.toml") + " --noise white --threads 1 -o " + path("result"));
    ASSERT_EQ(fitted.exit_code, 0) << fitted.output << fitted.errors;
    ASSERT_THAT(fitted.output, HasSubstr("29 of 29 errors identified"));
  }
  static void TearDownTestSuite() { scratch_.reset(); }

  static std::string path(const std::string& name) { return (scratch_->path() / name).string(); }
  static void write(const std::string& name, const std::string& text) {
    std::ofstream(scratch_->path() / name, std::ios::binary) << text;
  }
  static nlohmann::json json_of(const std::string& command) {
    const auto run = run_program(command + " --json");
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return nlohmann::json::parse(run.output);
  }

  static std::unique_ptr<testing::ScratchFolder> scratch_;
};
std::unique_ptr<testing::ScratchFolder> Quill::scratch_;

/// The machine file that the simulation writes is the one it read; readings have the columns of W.
TEST_F(Quill, IsWrittenAndReadBack) {
  EXPECT_THAT(content(path("campaign/machine.toml")),
              AllOf(HasSubstr("structure = \"w X' b Y Z W t\""), HasSubstr("[axes.W]")));
  EXPECT_THAT(content(path("campaign/P1_short.csv")),
              HasSubstr("x_mm,y_mm,z_mm,w_mm,dir_x,dir_y,dir_z,dir_w"));
  EXPECT_THAT(content(path("campaign/truth/error_functions.csv")),
              AllOf(HasSubstr("\nEXW,W,"), HasSubstr("\nEB0W,")));
}

TEST_F(Quill, IsPredictedAtPosesOfAllAxes) {
  const auto figures = json_of("validate " + path("result") + " " + path("campaign/truth/campaign.toml"));
  EXPECT_GT(figures.at("rms_before_um").get<double>(), 10.0);
  EXPECT_LT(figures.at("rms_after_um").get<double>(), 1.0);
  EXPECT_GT(figures.at("coverage95").get<double>(), 0.8);
}

/// Z advanced and W advanced by as much reach one point and have other errors.
TEST_F(Quill, ErrorsDependOnWhichAxisGoes) {
  const auto at = [&](const std::string& place) {
    return json_of("tables " + path("result") + " --tool side --at " + place).at("volumetric_errors").at(0);
  };
  const auto by_z = at("X=500,Y=400,Z=-300,W=-50"), by_w = at("X=500,Y=400,Z=-50,W=-300");
  EXPECT_NE(by_z.at("error_um"), by_w.at("error_um"));
  EXPECT_EQ(by_w.at("position").at("W").get<double>(), -300.0);
}

TEST_F(Quill, StandsInTheTables) {
  const auto run = run_program("tables " + path("result") + " -o " + path("tables"));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(content(path("tables/error_tables.csv")), AllOf(HasSubstr("\nEZW,W,"), HasSubstr("\nEA0W,,")));
  EXPECT_THAT(content(path("tables/volumetric_grid.csv")), HasSubstr("x_mm,y_mm,z_mm,w_mm,tool"));
  const auto again = json_of("tables " + path("tables") + " --tool side --at X=500,Y=400,Z=-50,W=-300");
  const auto first = json_of("tables " + path("result") + " --tool side --at X=500,Y=400,Z=-50,W=-300");
  for (int k = 0; k < 3; ++k) {
    const auto value = [k](const nlohmann::json& json) {
      return json.at("volumetric_errors").at(0).at("error_um").at(k).get<double>();
    };
    EXPECT_NEAR(value(again), value(first), 0.3);
  }
}

/// The quill's errors are zero at its home and not at the ends of its travel; csv holds both.
TEST_F(Quill, LeavesWhatIsSaidWithWAtHomeAndOverItsTravel) {
  const std::string command = "tables " + path("result") + " --tool side --dry-run";
  EXPECT_THAT(run_program(command).output,
              AllOf(HasSubstr("Error left in the volume, W at -50 mm"),
                    HasSubstr("before, W from -400 to 50 mm"), HasSubstr("tables, W from -400 to 50 mm")));
  const auto left = json_of(command).at("error_left");
  EXPECT_EQ(left.at("parallel_axes_at_mm").at("W").get<double>(), -50.0);
  const auto& over = left.at("over_parallel_axes");
  EXPECT_EQ(over.at("travel_mm").at("W"), nlohmann::json::array({-400.0, 50.0}));
  const auto rms = [](const nlohmann::json& of) { return of.at("rms_um").get<double>(); };
  EXPECT_NE(rms(over.at("before")), rms(left.at("before")));
  EXPECT_LT(rms(over.at("tables")), 1.0);
  EXPECT_GT(rms(over.at("tables")), 0.0);
}

/// The control with csv tables moves X, Y, Z against the errors of the quill.
TEST_F(Quill, IsCompensatedByXYZ) {
  ASSERT_EQ(run_program("tables " + path("result") + " --tool short -o " + path("active")).exit_code, 0);
  const auto run = run_program("simulate " + path("study.toml") + " --compensation " + path("active") +
                               " -o " + path("compensated"));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto figures = json_of("compare " + path("compensated/truth/campaign.toml") + " nominal");
  EXPECT_LT(figures.at("models").at(0).at("total").at("lengths_um").at("rms").get<double>(), 1.0);
}

TEST_F(Quill, HasFiguresOfItsLinesAndCircles) {
  const auto figures = json_of("compare " + path("campaign/campaign.toml") + " " + path("result"));
  const auto& standards = figures.at("models").at(0).at("standards");
  std::string lines, planes;
  for (const auto& test : standards.at("iso230_2")) lines += test.at("axis").get<std::string>();
  for (const auto& test : standards.at("iso230_4")) planes += test.at("plane").get<std::string>() + " ";
  EXPECT_EQ(lines, "WZ");
  EXPECT_EQ(planes, "WX ZX ");
}

TEST_F(Quill, IsInTheBudgetOfErrorsAndTolerances) {
  for (const std::string& of : {path("result"), path("machine.toml")}) {
    const auto run = run_program("budget " + of + " --verbose");
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    for (const char* symbol : {"EXW", "EZW", "EA0W", "EB0W"})
      EXPECT_THAT(run.output, HasSubstr(symbol)) << of;
  }
}

TEST_F(Quill, IsRefusedByWhatCannotTakeIt) {
  write("program.ngc", "G21 G90\nG0 X0 Y0 Z0\n");
  const std::string out = " -o " + path("refused");
  for (const std::string& command :
       {"align " + path("result") + " --primary Z --secondary X" + out, "plan " + path("machine.toml") + out,
        "compensate " + path("result") + " " + path("program.ngc") + out}) {
    const auto run = run_program(command);
    EXPECT_NE(run.exit_code, 0) << command;
    EXPECT_THAT(run.errors,
                AllOf(HasSubstr("cannot take the parallel axis W of this machine ("), HasSubstr(")")))
        << command;
  }
  const auto formats = json_of("tables --list").at("formats");
  EXPECT_GT(formats.size(), 10U);
  for (const auto& format : formats) {
    const std::string name = format.at("name");
    if (name == "csv") continue;
    const auto run = run_program("tables " + path("result") + " --format " + name + out);
    EXPECT_NE(run.exit_code, 0) << name;
    EXPECT_THAT(run.errors, AllOf(HasSubstr("the format " + name + " cannot take the parallel axis W"),
                                  HasSubstr("write --format csv")));
  }
  EXPECT_FALSE(std::filesystem::exists(path("refused")));
}

TEST_F(Quill, NeverGivesTheFrame) {
  write("frame.toml", std::string(kQuillMachine) + "[datum]\nprimary = \"W\"\nsecondary = \"X\"\n");
  const auto run = run_program("budget " + path("frame.toml"));
  EXPECT_NE(run.exit_code, 0);
  EXPECT_THAT(run.errors,
              AllOf(HasSubstr("datum.primary = \"W\" is not one of X, Y, Z"), HasSubstr("frame.toml:")));
}

TEST_F(Quill, HasATemplate) {
  const auto run = run_program("init \"w X' b Y Z W t\" -o " + path("template"));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(content(path("template/machine.toml")), HasSubstr("[axes.W]  # beside Z"));
  EXPECT_THAT(content(path("template/campaign.toml")), HasSubstr("x_mm,y_mm,z_mm,w_mm,"));
  EXPECT_THAT(run_program("init \"w X b Y W t\" -o " + path("no")).errors, HasSubstr("name the axis Z"));
}

}  // namespace
}  // namespace volcal
