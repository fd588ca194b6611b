/// Files as instruments and controls write them, from the program's point of view: read, or refused with a
/// remedy that can be followed.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/support/long_tests.h"
#include "tests/support/program.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using testing::content;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_program;

class InputCase : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (scratch_.path() / name).string(); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(scratch_.path() / name, std::ios::binary) << text;
  }
  /// A machine of X, Y and Z, 300 mm each, without tool offset.
  void write_machine() const {
    std::string text = "format = \"volcal-machine-1\"\nstructure = \"w b X Y Z t\"\n";
    for (const char axis : {'X', 'Y', 'Z'})
      text += std::string("[axes.") + axis + "]\ntravel_mm = [-300.0, 300.0]\nhome_mm = 0.0\n";
    write("machine.toml", text + "[tools.t]\noffset_mm = [0.0, 0.0, 0.0]\n");
  }
  void write_campaign(const std::string& setup, const std::string& head = "") const {
    write("campaign.toml", "format = \"volcal-campaign-1\"\nmachine = \"machine.toml\"\n" + head +
                               "[[setups]]\nname = \"S\"\n" + setup);
  }
  static nlohmann::json figures(const std::string& campaign) {
    const auto run = run_program("compare " + campaign + " nominal --json");
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return nlohmann::json::parse(run.output)["models"][0]["standards"]["iso230_2"][0];
  }

  testing::ScratchFolder scratch_;
};

/// By the formulas of ISO 230-2 on the exact targets; recorded with +-1 um they are the same targets.
TEST_F(InputCase, ScatteredTargetsGiveTheFiguresOfTheirTargets) {
  const std::string folder = VOLCAL_SOURCE_DIR "/tests/data/jittered-targets/";
  for (const char* campaign : {"a.toml", "h.toml"}) {
    const auto test = figures(folder + campaign);
    const auto& readings = test["readings"];
    EXPECT_NEAR(readings["E_um"].get<double>(), 117.94, 0.005) << campaign;
    EXPECT_NEAR(readings["R_um"].get<double>(), 36.85, 0.005) << campaign;
    EXPECT_NEAR(readings["A_um"].get<double>(), 137.31, 0.005) << campaign;
    EXPECT_NEAR(readings["B_um"].get<double>(), 23.56, 0.005) << campaign;
  }
  EXPECT_THAT(figures(folder + "h.toml")["notes"].dump(), HasSubstr("um were taken as one target"));
  EXPECT_THAT(figures(folder + "a.toml")["notes"].dump(), Not(HasSubstr("taken as one target")));
}

/// A gauge block at four places, each with its own zero.
class GaugeBlock : public InputCase {
 protected:
  void SetUp() override {
    write_machine();
    write(
        "gauge.csv",
        "x_mm,y_mm,z_mm,displacement_mm,line\n-280,0,0,0,1\n-254.989,0,0,25.000,1\n-258,0,0,0,2\n"
        "-232.981,0,0,25.000,2\n-240,0,0,0,3\n-215.009,0,0,25.000,3\n-217,0,0,0,4\n-192.006,0,0,25.000,4\n");
    write_campaign(
        "instrument = \"displacement\"\ndata = \"gauge.csv\"\ndirection = [1, 0, 0]\noffset_per = "
        "\"line\"\nnoise = { constant_um = 3.0 }\n");
    write("model.toml",
          "format = \"volcal-model-1\"\n[functions]\ndefault = { basis = \"zero\" }\n"
          "EXX = { basis = \"legendre\", degree = 1 }\n[locations]\nEC0Y = \"zero\"\nEA0Z = \"zero\"\n"
          "EB0Z = \"zero\"\n");
  }
};

/// Of two readings with an offset of their own the w-test flags both alike; one of them has to stay.
TEST_F(GaugeBlock, OneOfTwoReadingsOnALineStaysWhereOutliersGo) {
  const std::string model = " --model " + path("model.toml");
  const auto fit =
      run_program("fit " + path("campaign.toml") + model + " --outliers remove --json -o " + path("result"));
  ASSERT_EQ(fit.exit_code, 0) << fit.errors;
  const auto setups = nlohmann::json::parse(fit.output).at("setups");
  EXPECT_GE(setups.at(0).at("observations").get<int>(), 4) << "a line has its own zero";
  EXPECT_LT(setups.at(0).at("observations").get<int>(), 8);
  const auto diagnosis =
      run_program("diagnose " + path("campaign.toml") + model + " -o " + path("diagnosis"));
  EXPECT_EQ(diagnosis.exit_code, 0) << diagnosis.errors;
}

/// Nothing compares them.
TEST_F(GaugeBlock, LinesWithTargetsAndZerosOfTheirOwnGiveNoFigure) {
  const auto test = figures(path("campaign.toml"));
  for (const char* figure : {"A_um", "E_um", "M_um", "R_um", "B_um"})
    EXPECT_TRUE(test["readings"][figure].is_null());
  for (const char* side : {"positive", "negative"}) {
    for (const char* figure : {"A_um", "E_um", "R_um"})
      EXPECT_TRUE(test["readings"][side][figure].is_null()) << figure;
  }
  EXPECT_THAT(test["notes"].dump(), HasSubstr("no figure compares them"));
}

/// Heights of a plane tilted by 200 and -100 urad: the alignment of the board takes it, nothing is left.
TEST_F(InputCase, AHeightMapIsOneComponent) {
  write_machine();
  std::string csv = "x_mm,y_mm,z_mm,ez_um\n";
  for (int y = 0; y <= 4; ++y) {
    for (int x = 0; x <= 4; ++x)
      csv += std::to_string(60 * x) + "," + std::to_string(60 * y) + ",0," +
             std::to_string(12.0 * x - 6.0 * y) + "\n";
  }
  write("map.csv", csv);
  write("model.toml",
        "format = \"volcal-model-1\"\n[functions]\ndefault = { basis = \"zero\" }\n[locations]\nEC0Y = "
        "\"zero\"\n"
        "EA0Z = \"zero\"\nEB0Z = \"zero\"\n");
  write_campaign("instrument = \"volumetric-points\"\ndata = \"map.csv\"\nnoise = { constant_um = 1.0 }\n");
  const auto run = run_program("compare " + path("campaign.toml") + " " + path("model.toml") + " --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto total = nlohmann::json::parse(run.output)["models"][0]["total"];
  EXPECT_EQ(total["observations"], 25);
  EXPECT_LT(total["lengths_um"]["rms"].get<double>(), 0.01);
}

TEST_F(InputCase, AMissingComponentIsNotReadFromAnotherOne) {
  write_machine();
  write("map.csv", "x_mm,y_mm,z_mm,Ex,Ez\n0,0,0,1,1\n10,0,0,1,1\n");
  write_campaign("instrument = \"volumetric-points\"\ndata = \"map.csv\"\nnoise = { constant_um = 1.0 }\n");
  const auto run = run_program("compare " + path("campaign.toml") + " nominal");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("volumetric-points reads ex_um, ey_um, ez_um"));
  EXPECT_THAT(run.errors, Not(HasSubstr("ex_um = \"Ez\"")));
}

class OneAxis : public InputCase {
 protected:
  void SetUp() override {
    write("machine.toml",
          "format = \"volcal-machine-1\"\nstructure = \"w b X t\"\n[axes.X]\ntravel_mm = [-20.0, "
          "20.0]\nhome_mm = "
          "0.0\n[tools.target]\noffset_mm = [0.0, 0.0, 0.0]\n");
    std::string csv = "cycle;dir;Target;Ref\n";
    for (int cycle = 1; cycle <= 3; ++cycle) {
      for (int k = -4; k <= 4; ++k) csv += row(cycle, 1, 5 * k);
      for (int k = 4; k >= -4; --k) csv += row(cycle, -1, 5 * k);
    }
    write("raw.csv", csv);
    write_campaign(
        "instrument = \"displacement\"\ndata = \"raw.csv\"\ndirection = [1, 0, 0]\ndelimiter = \";\"\n"
        "columns = { x_mm = \"Target\", displacement_mm = \"Ref\", dir_x = \"dir\", run = \"cycle\" }\n"
        "noise = { constant_um = 1.0 }\n");
  }
  /// 2 um per mm, 4 um of reversal, +-1 um by cycle.
  static std::string row(int cycle, int direction, int target) {
    const double deviation_um = 2.0 * target + 2.0 * direction + (cycle - 2);
    return std::to_string(cycle) + ";" + std::to_string(direction) + ";" + std::to_string(target) + ";" +
           std::to_string(target + deviation_um * 1e-3) + "\n";
  }
};

TEST_F(OneAxis, HasItsFigures) {
  const auto readings = figures(path("campaign.toml"))["readings"];
  EXPECT_NEAR(readings["E_um"].get<double>(), 84.0, 1e-6);  // 2 um/mm x 40 mm + 4 um
  EXPECT_NEAR(readings["B_um"].get<double>(), 4.0, 1e-6);
  EXPECT_NEAR(readings["R_um"].get<double>(), 8.0, 1e-6);  // 2 s + 2 s + |B| with s = 1 um
}

TEST_F(OneAxis, IsIdentified) {
  write(
      "model.toml",
      "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n[functions]\ndefault = { basis = \"zero\" }\n"
      "EXX = { basis = \"bspline\", degree = 1, knots = 4 }\n[[effects]]\nkind = \"reversal\"\nsymbol = "
      "\"EXX\"\n");
  const auto run = run_program("fit " + path("campaign.toml") + " --model " + path("model.toml") + " -o " +
                               path("result"));
  ASSERT_EQ(run.exit_code, 0) << run.output << run.errors;
  EXPECT_THAT(content(path("result/error_tables.csv")), HasSubstr("EXX,X,20"));
  const auto again = run_program("compare " + path("campaign.toml") + " " + path("result"));
  EXPECT_EQ(again.exit_code, 0) << again.errors;
}

TEST_F(OneAxis, RemediesSayWhatToSwitchOff) {
  const auto all = run_program("fit " + path("campaign.toml") + " --verbose -o " + path("result"));
  EXPECT_EQ(all.exit_code, 1) << all.errors;
  EXPECT_THAT(all.output, HasSubstr("[functions] EYX = { basis = \"zero\" }"));
  EXPECT_THAT(all.output, Not(HasSubstr("station"))) << "there is none";
  write("model.toml", "format = \"volcal-model-1\"\n[functions]\nEC0Y = { basis = \"zero\" }\n");
  const auto squareness = run_program("fit " + path("campaign.toml") + " --model " + path("model.toml") +
                                      " -o " + path("result"));
  EXPECT_EQ(squareness.exit_code, 2);
  EXPECT_THAT(squareness.errors, HasSubstr("a machine with one linear axis has no squareness"));
}

TEST_F(InputCase, SquarenessBelowFunctionsIsSentToLocations) {
  write_machine();
  write("line.csv", "x_mm,y_mm,z_mm,displacement_mm\n0,0,0,0\n100,0,0,100\n");
  write_campaign("instrument = \"displacement\"\ndata = \"line.csv\"\nnoise = { constant_um = 1.0 }\n");
  write("model.toml", "format = \"volcal-model-1\"\n[functions]\nEC0Y = { basis = \"zero\" }\n");
  const auto run = run_program("fit " + path("campaign.toml") + " --model " + path("model.toml") + " -o " +
                               path("result"));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("[locations]: EC0Y = \"zero\" switches it off"));
  EXPECT_THAT(run.errors, Not(HasSubstr("did you mean")));
}

/// X measured on 40 mm of its 120 mm of travel, 1 um per mm and a reversal of 6 um.
class PartlyMeasured : public InputCase {
 protected:
  void SetUp() override {
    std::string machine = "format = \"volcal-machine-1\"\nstructure = \"w b X Y Z t\"\n";
    for (const char axis : {'X', 'Y', 'Z'})
      machine += std::string("[axes.") + axis + "]\ntravel_mm = [-60.0, 60.0]\nhome_mm = 0.0\n";
    write("machine.toml", machine + "[tools.t]\noffset_mm = [0.0, 0.0, 0.0]\n");
    std::string csv = "x_mm,y_mm,z_mm,deviation_um,dir_x\n";
    for (int cycle = -1; cycle <= 1; ++cycle) {
      for (int k = -4; k <= 4; ++k) csv += row(cycle, 1, 5 * k);
      for (int k = 4; k >= -4; --k) csv += row(cycle, -1, 5 * k);
    }
    write("line.csv", csv);
    write_campaign(
        "instrument = \"displacement\"\ndata = \"line.csv\"\ndirection = [1, 0, 0]\n"
        "noise = { constant_um = 1.0 }\n");
    write("model.toml",
          "format = \"volcal-model-1\"\n[functions]\ndefault = { basis = \"zero\" }\n"
          "EXX = { basis = \"bspline\", degree = 1, knots_mm = [-60, -20, 0, 20, 60] }\n[locations]\n"
          "EC0Y = \"zero\"\nEA0Z = \"zero\"\nEB0Z = \"zero\"\n"
          "[[effects]]\nkind = \"reversal\"\nsymbol = \"EXX\"\n");
    const auto fit = run_program("fit " + path("campaign.toml") + " --model " + path("model.toml") + " -o " +
                                 path("result"));
    ASSERT_LE(fit.exit_code, 1) << fit.errors;
  }
  static std::string row(int cycle, int direction, int x) {
    return std::to_string(x) + ",0,0," + std::to_string(x + 3 * direction + 0.5 * cycle) + "," +
           std::to_string(direction) + "\n";
  }

  static constexpr const char* kHeld =
      "X was measured from -20 to 20 of -60 to 60 mm: beyond it the last measured error is held";
};

/// The result, the model and the tables that it writes say the same of every position, and judge readings
/// alike.
TEST_F(PartlyMeasured, WhatIsWrittenHoldsTheLastErrorToo) {
  ASSERT_EQ(run_program("tables " + path("result") + " -o " + path("tables")).exit_code, 0);
  write("beyond.csv",
        "x_mm,y_mm,z_mm,ex_um,ey_um,ez_um,dir_x\n0,0,0,3,0,0,1\n15,0,0,18,0,0,1\n"
        "50,0,0,23,0,0,1\n-60,0,0,-17,0,0,1\n");
  write("beyond.toml",
        "format = \"volcal-campaign-1\"\nmachine = \"machine.toml\"\n[[setups]]\nname = \"P\"\n"
        "instrument = \"volumetric-points\"\ndata = \"beyond.csv\"\nalignment = \"none\"\n"
        "noise = { constant_um = 1.0 }\n");
  for (const std::string& errors : {path("result"), path("result/identified.toml"), path("tables")}) {
    const std::string tables = "tables " + errors + " --approach X+ --at X=60";
    const auto at_end = nlohmann::json::parse(run_program(tables + " --json").output).at("volumetric_errors");
    EXPECT_NEAR(at_end.at(0).at("error_um").at(0).get<double>(), 23.0, 0.5) << errors;
    EXPECT_TRUE(at_end.at(0).at("extrapolated").get<bool>()) << errors;
    EXPECT_EQ(run_program(tables + " --no-extrapolation").exit_code, 2) << errors;
    EXPECT_THAT(run_program("tables " + errors + " --format linuxcnc --dry-run").output,
                HasSubstr("beyond it the last measured error is held"))
        << errors;
    const auto validated = run_program("validate " + errors + " " + path("beyond.toml"));
    ASSERT_EQ(validated.exit_code, 0) << validated.errors;
    EXPECT_THAT(validated.output, HasSubstr("beyond it the last measured error is held")) << errors;
    const auto judged = nlohmann::json::parse(
        run_program("validate " + errors + " " + path("beyond.toml") + " --json").output);
    EXPECT_LT(judged.at("max_after_um").get<double>(), 1.0) << errors;
    const auto compared = run_program("compare " + path("beyond.toml") + " " + errors);
    EXPECT_THAT(compared.output, HasSubstr("beyond it the last measured error is held")) << errors;
  }
}

/// What each format needs to be told; all that are registered.
const std::vector<std::string> kFormats = {"csv",
                                           "neutral-csv",
                                           "linuxcnc",
                                           "linuxcnc-grid",
                                           "klipper",
                                           "marlin",
                                           "isg-csv",
                                           "etalon-exchange",
                                           "isg-ssfk",
                                           "sinumerik",
                                           "sinumerik-cec --set cec_sign=error",
                                           "heidenhain --set sign=error",
                                           "fanuc --set sign=error --set output=even --set directions=mean"};

TEST_F(PartlyMeasured, EveryFormatSaysWhereItHoldsTheLastErrorOrRefuses) {
  const std::string tables = "tables " + path("result") + " --dry-run --format ";
  for (const std::string& format : kFormats) {
    const auto held = run_program(tables + format);
    EXPECT_EQ(held.exit_code, 0) << format << held.errors;
    EXPECT_THAT(held.output, HasSubstr(kHeld)) << format;
    const auto refused = run_program(tables + format + " --no-extrapolation");
    EXPECT_EQ(refused.exit_code, 2) << format;
    EXPECT_THAT(refused.errors, HasSubstr("X was measured from -20 to 20")) << format;
  }
  const auto known = nlohmann::json::parse(run_program("tables --list --json").output).at("formats");
  std::set<std::string> names;
  for (const auto& format : known) names.insert(format.at("name").get<std::string>());
  for (const std::string& format : kFormats) names.erase(format.substr(0, format.find(' ')));
  EXPECT_THAT(names, ::testing::ElementsAre("linuxcnc-trt")) << "it is for machines with rotary axes";
}

TEST_F(PartlyMeasured, PointsAndProgramsHoldTheLastErrorOrRefuse) {
  const auto ex_at = [&](const std::string& x) {
    const auto run = run_program("tables " + path("result") + " --json --approach X+ --at X=" + x);
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return nlohmann::json::parse(run.output).at("volumetric_errors").at(0);
  };
  EXPECT_NEAR(ex_at("20").at("error_um").at(0).get<double>() - ex_at("0").at("error_um").at(0).get<double>(),
              20.0, 0.5);
  for (const char* x : {"25", "60"}) {
    EXPECT_EQ(ex_at(x).at("error_um").at(0), ex_at("20").at("error_um").at(0)) << x;
    EXPECT_TRUE(ex_at(x).at("extrapolated").get<bool>()) << x;
    EXPECT_GT(ex_at(x).at("u_um").at(0), ex_at("20").at("u_um").at(0)) << x;
  }
  EXPECT_EQ(run_program("tables " + path("result") + " --no-extrapolation --at X=25").exit_code, 2);
  EXPECT_EQ(run_program("tables " + path("result") + " --no-extrapolation --at X=15").exit_code, 0);
  write("part.ngc", "G21 G90\nF600\nG0 X0 Y0 Z0\nG1 X50\nM2\n");
  const std::string compensate = "compensate " + path("result") + " " + path("part.ngc") +
                                 " --work-offset G54=X0,Y0,Z0 -o " + path("out.ngc");
  const auto held = run_program(compensate);
  EXPECT_EQ(held.exit_code, 0) << held.errors;
  EXPECT_THAT(held.output, HasSubstr("beyond the measured positions: the last measured error is held"));
  EXPECT_EQ(run_program(compensate + " --no-extrapolation").exit_code, 2);
}

TEST_F(InputCase, NamesAreShownWithoutControlCharacters) {
  write_machine();
  write_campaign(
      "instrument = \"displacement\"\ndata = \"li\x1b[31mne.csv\"\nnoise = { constant_um = 1.0 }\n");
  const auto raw = run_program("compare " + path("campaign.toml") + " nominal");
  EXPECT_EQ(raw.exit_code, 2);
  EXPECT_THAT(raw.errors, Not(HasSubstr("\x1b")));
  write_campaign(
      "instrument = \"displacement\"\ndata = \"li\\u001b[31mne.csv\"\nnoise = { constant_um = 1.0 }\n");
  const auto escaped = run_program("compare " + path("campaign.toml") + " nominal");
  EXPECT_EQ(escaped.exit_code, 2);
  EXPECT_THAT(escaped.errors, HasSubstr("control character"));
  EXPECT_THAT(escaped.errors, Not(HasSubstr("\x1b")));
  EXPECT_THAT(run_program("fit \"$(printf 'no\\033[31mthing.toml')\" -o x").errors, Not(HasSubstr("\x1b")));
}

TEST(CommandLine, AFullStandardOutputIsAnError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const std::string campaign = VOLCAL_SOURCE_DIR "/tests/data/jittered-targets/a.toml";
  for (const std::string& command : {"compare " + campaign + " nominal", std::string("diagnose --list"),
                                     std::string("--version"), std::string("compare --help")}) {
    const testing::ScratchFolder scratch;
    const std::string errors = (scratch.path() / "errors").string();
    const int status =
        std::system((std::string(VOLCAL_PROGRAM) + " " + command + " >/dev/full 2>" + errors).c_str());
    EXPECT_EQ(WEXITSTATUS(status), 1) << command;
    EXPECT_THAT(content(errors), HasSubstr("standard output cannot be written")) << command;
  }
}

TEST(Init, ForceOverwritesAndNamesTheEditedFile) {
  const testing::ScratchFolder scratch;
  const fs::path folder = scratch.path() / "machine";
  const std::string init = "init \"w X' b Y Z t\" -o " + folder.string();
  ASSERT_EQ(run_program(init).exit_code, 0);
  EXPECT_EQ(run_program(init).exit_code, 0) << "nothing was edited";
  std::ofstream(folder / "campaign.toml", std::ios::app) << "# mine\n";
  std::ofstream(folder / "readings.csv") << "x_mm\n";
  const auto refused = run_program(init);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("campaign.toml: it has been edited"));
  EXPECT_THAT(refused.errors, HasSubstr("--force"));
  EXPECT_EQ(run_program(init + " --force").exit_code, 0);
  EXPECT_THAT(content(folder / "campaign.toml"), Not(HasSubstr("# mine")));
  EXPECT_TRUE(fs::exists(folder / "readings.csv")) << "files of other names stay";
}

/// The files of `init` as they stand: planned with a tracer, measured, identified; nothing is invisible.
/// With functions of degree 2, of a machine without errors, in every run; with those of its model file for
/// the night.
TEST(Init, ItsMachineIsPlannedMeasuredAndIdentified) {
  const testing::ScratchFolder scratch;
  const auto in = [&](const std::string& name) { return (scratch.path() / name).string(); };
  ASSERT_EQ(run_program("init \"w X' b Y Z t\" -o " + in("machine")).exit_code, 0);
  std::string model = in("machine/model.toml");
  if (!testing::long_tests()) {
    model = in("quadratic.toml");
    std::ofstream(model) << "format = \"volcal-model-1\"\nmachine = \"machine/machine.toml\"\n[functions]\n"
                            "default = { basis = \"legendre\", degree = 2 }\n";
  }
  const auto plan = run_program("plan " + in("machine/machine.toml") + " --model " + model +
                                " --readings 960 --seed 1 -o " + in("plan"));
  ASSERT_EQ(plan.exit_code, 0) << plan.errors;
  if (!testing::long_tests())
    std::ofstream(in("plan/study.toml"), std::ios::app) << "\n[truth]\nkind = \"perfect\"\n";
  EXPECT_THAT(plan.output, Not(HasSubstr("cannot determine")));
  const auto simulated = run_program("simulate " + in("plan/study.toml") + " -o " + in("campaign"));
  ASSERT_EQ(simulated.exit_code, 0) << simulated.errors;
  const auto fit =
      run_program("fit " + in("campaign/campaign.toml") + " --model " + model + " -o " + in("result"));
  EXPECT_EQ(fit.exit_code, 0) << fit.output << fit.errors;
  EXPECT_THAT(fit.output, Not(HasSubstr("not visible")));
}

TEST(Init, AMachineOfOneAxisHasNoDatum) {
  const testing::ScratchFolder scratch;
  const std::string folder = (scratch.path() / "machine").string();
  ASSERT_EQ(run_program("init \"w b X t\" -o " + folder).exit_code, 0);
  EXPECT_THAT(content(folder + "/machine.toml"), Not(HasSubstr("[datum]")));
  const auto list = run_program("fit " + folder + "/campaign.toml -o " + folder + "/result");
  EXPECT_THAT(list.errors, HasSubstr("key setups is missing")) << "the machine itself is read";
}

TEST(Simulate, RefusesAFolderWithEditedFiles) {
  const testing::ScratchFolder scratch;
  const std::string folder = (scratch.path() / "campaign").string();
  std::ofstream(scratch.path() / "study.toml")
      << "format = \"volcal-study-1\"\nmachine = \"" VOLCAL_SOURCE_DIR
         "/datasets/demo/machine.toml\"\nseed = 3\n[[measurements]]\nkind = \"diagonals\"\n";
  const std::string simulate = "simulate " + (scratch.path() / "study.toml").string() + " -o " + folder;
  const auto first = run_program(simulate);
  ASSERT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_EQ(run_program(simulate).exit_code, 0) << "nothing was edited";
  std::ofstream(folder + "/campaign.toml", std::ios::app) << "# mine\n";
  const auto refused = run_program(simulate);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("campaign.toml: it has been edited"));
  EXPECT_EQ(run_program(simulate + " --force").exit_code, 0);
  EXPECT_THAT(content(folder + "/campaign.toml"), Not(HasSubstr("# mine")));
}

TEST(Extend, AsksBeforeItOverwritesItsInput) {
  const testing::ScratchFolder scratch;
  const std::string model = (scratch.path() / "model.toml").string();
  const std::string text = "format = \"volcal-model-1\"\nmachine = \"" VOLCAL_SOURCE_DIR
                           "/datasets/demo/machine.toml\"\n[functions]\n";
  std::ofstream(model) << text;
  const std::string extend = "extend " + model + " --effect reversal:EXX -o " + model;
  const auto refused = run_program(extend);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("--force"));
  EXPECT_EQ(content(model), text);
  EXPECT_EQ(run_program(extend + " --force").exit_code, 0);
  EXPECT_THAT(content(model), HasSubstr("reversal"));
}

}  // namespace
}  // namespace volcal
