/// NC programs rewritten from the command line, for a machine that the program itself has identified.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/simulated_campaign.h"

namespace volcal {
namespace {

using testing::content;
using ::testing::HasSubstr;
using testing::run_program;

const std::string kPart =
    "%\n(pocket)\nG21 G90 G17\nF1000\nT1 M6\nS3000 M3\nG43 H1\nG0 X-150 Y-100 Z50\nG1 Z-20 "
    "F300\nF1500\nX150\nY100\n"
    "G3 X-150 Y100 R150\nG1 Y-100\nG0 Z50\nM30\n%\n";
const std::string kSetup = " --work-offset G54=X10,Y-20,Z-350 --tool-length H1=150";

class CompensatedPrograms : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    simulated_ = new testing::SimulatedCampaign;
    simulated_->simulate(8,
                         "[[measurements]]\nkind = \"laser-tracer\"\ngrid = [5, 4, 4]\n"
                         "[validation]\npoints = 5\n",
                         3, 4);
    const auto run = simulated_->fit("--noise white");
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    std::ofstream(simulated_->path("part.ngc")) << kPart;
  }
  static void TearDownTestSuite() {
    delete simulated_;
    simulated_ = nullptr;
  }
  static std::string path(const std::string& name) { return simulated_->path(name); }
  static auto compensate(const std::string& options, const std::string& program = "part.ngc") {
    return run_program("compensate " + path("result") + " " + path(program) + " " + options);
  }

 private:
  static testing::SimulatedCampaign* simulated_;
};

testing::SimulatedCampaign* CompensatedPrograms::simulated_ = nullptr;

TEST_F(CompensatedPrograms, AreWrittenAndChecked) {
  const auto run = compensate("-o " + path("out.ngc") + kSetup + " --check");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("lines in, "));
  EXPECT_THAT(run.output, HasSubstr("Functional point X0 Y0 Z-150 mm from the spindle reference"));
  EXPECT_THAT(run.output, HasSubstr("Error of the tool point along "));
  const std::string text = content(path("out.ngc"));
  EXPECT_THAT(text, ::testing::StartsWith("%\n(volcal compensate: result "));
  EXPECT_THAT(
      text,
      HasSubstr("G54=X10,Y-20,Z-350 H1=150)\n(pocket)\nG21 G90 G17\nF1000\nT1 M6\nS3000 M3\nG43 H1\nG0 X"));
  EXPECT_THAT(text, ::testing::EndsWith("M30\n%\n"));
  for (const auto& entry : std::filesystem::directory_iterator(path("")))
    EXPECT_EQ(entry.path().filename().string().find(".part"), std::string::npos);
}

TEST_F(CompensatedPrograms, ErrorFallsInTheSameTime) {
  const auto run = compensate("--check --json" + kSetup);
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto json = nlohmann::json::parse(run.output);
  const auto& check = json.at("check");
  const double before = check.at("before").at("rms_um"), after = check.at("after").at("rms_um");
  EXPECT_GT(before, 1.0);
  EXPECT_LT(after, 0.5);
  EXPECT_LT(after, before / 10.0);
  EXPECT_LT(check.at("after").at("max_um").get<double>(), 1.2) << "half an um of path and half of chords";
  const double time = check.at("before").at("feed_time_s");
  EXPECT_NEAR(check.at("after").at("feed_time_s").get<double>(), time, 0.01 * time);
  EXPECT_EQ(json.at("arcs"), 1);
  EXPECT_FALSE(json.contains("file"));
}

TEST_F(CompensatedPrograms, DependOnTheToleranceAndTheTool) {
  const auto lines = [](const std::string& options) {
    return nlohmann::json::parse(compensate("--check --json" + kSetup + " " + options).output);
  };
  const auto fine = lines("--tolerance-um 0.1 --arc-tolerance-um 0.1"),
             coarse = lines("--tolerance-um 5 --arc-tolerance-um 5");
  EXPECT_GT(fine.at("lines_written").get<int>(), 2 * coarse.at("lines_written").get<int>());
  EXPECT_LT(fine.at("check").at("after").at("rms_um").get<double>(),
            coarse.at("check").at("after").at("rms_um").get<double>());
  const auto differences = lines("--lengths-from side_x");
  EXPECT_NE(differences.at("functional_points_mm"), fine.at("functional_points_mm"));
}

TEST_F(CompensatedPrograms, RefuseBadInput) {
  std::ofstream(path("probe.ngc")) << "G21\nG38.2 Z-5 F10\n";
  std::ofstream(path("binary.ngc")) << "G21\n" << '\0' << "\n";
  const std::string out = "-o " + path("refused.ngc");
  const std::vector<std::pair<std::string, std::string>> refused = {
      {"", "give -o OUT.ngc, --check, or both"},
      {"-o " + path("part.ngc"), "the output is the program itself"},
      {out, "part.ngc:7: the length of tool H1 is not given (add --tool-length H1=LENGTH in mm)"},
      {out + " --tool-length H1=150",
       "part.ngc:8: the program moves in G54, whose offset is not given (add --work-offset "
       "G54=X...,Y...,Z... in mm)"},
      {out + " --tool-length H1=150 --work-offset G54=X0,Y0,Z100", "outside the identified travel"},
      {out + " --work-offset G54=X0,Y0", "--work-offset G54: Z is not given"},
      {out + " --work-offset G54=X0,Y0,Zten", "\"ten\" is not a length in mm"},
      {out + " --work-offset G53=X0,Y0,Z0", "--work-offset G53 is not a work offset"},
      {out + " --work-offset X0,Y0,Z0", "write G54=X10,Y20,Z-300 in mm"},
      {out + " --work-offset G54=X0,Y0,Z0 --work-offset G54=X0,Y0,Z0", "--work-offset G54 is given twice"},
      {out + " --tool-length 1=150", "write H1=150.2 in mm"},
      {out + " --tool wrong" + kSetup, "the machine has no such tool"},
      {out + " --tolerance-um 0" + kSetup, "must be positive"},
      {"-o " + path("nowhere/out.ngc") + kSetup, "creating the file failed"},
      {"-o " + path("result") + kSetup, "the output is a directory"},
  };
  for (const auto& [options, message] : refused) {
    const auto run = compensate(options);
    EXPECT_EQ(run.exit_code, 2) << options;
    EXPECT_THAT(run.errors, HasSubstr(message)) << options;
    EXPECT_EQ(run.output, "") << options;
  }
  EXPECT_THAT(compensate(out, "probe.ngc").errors, HasSubstr("probe.ngc:2: G38.2 (probing) is not followed"));
  EXPECT_THAT(compensate(out, "binary.ngc").errors, HasSubstr("the file is binary"));
  ASSERT_EQ(::mkfifo(path("pipe.ngc").c_str(), 0600), 0);
  EXPECT_THAT(compensate(out, "pipe.ngc").errors, HasSubstr("is a pipe, a file is expected (save"));
  EXPECT_THAT(compensate(out, "part.nc").errors, HasSubstr("did you mean \"part.ngc\"?"));
  EXPECT_FALSE(std::filesystem::exists(path("refused.ngc")));
}

TEST_F(CompensatedPrograms, AreNotCompensatedTwiceAndKeepTheOldFileWhenRefused) {
  ASSERT_EQ(compensate("-o " + path("once.ngc") + kSetup).exit_code, 0);
  const std::string once = content(path("once.ngc"));
  EXPECT_THAT(
      compensate("-o " + path("twice.ngc") + kSetup, "once.ngc").errors,
      HasSubstr("once.ngc:2: the program has been compensated already (compensate the original program)"));
  EXPECT_EQ(compensate("-o " + path("once.ngc")).exit_code, 2);
  EXPECT_EQ(content(path("once.ngc")), once);
}

/// The scale of X expands by 10 um/m/K from home at 0: at 25 degC the tool is 20 um too far at X400.
class ConditionsOfPrograms : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  void write_machine(const std::string& structure, const std::string& axes) const {
    std::ofstream machine(path("machine.toml"));
    machine << "format = \"volcal-machine-1\"\nname = \"by hand\"\nstructure = \"" << structure
            << "\"\n[datum]\nprimary = \"X\"\nsecondary = \"Y\"\n";
    for (const char axis : axes) {
      const bool rotary = axis == 'A' || axis == 'C';
      machine << "[axes." << axis << "]\n"
              << (rotary ? "travel_deg = [-180.0, 180.0]\nhome_deg = 0.0\ncentre_mm = [0.0, 0.0, 0.0]\n"
                         : "travel_mm = [-500.0, 500.0]\nhome_mm = 0.0\n"
                           "reference_point_mm = [0.0, 0.0, 0.0]\n");
    }
    machine << "[tools.t]\noffset_mm = [0.0, 0.0, -200.0]\n";
    std::ofstream(path("model.toml"))
        << "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n[functions]\n"
           "default = { basis = \"zero\" }\n[[effects]]\nkind = \"scale-expansion\"\naxis = \"X\"\n"
           "temperature = \"air\"\namplitude_um_per_m_K = 10.0\n";
  }

  std::string rewritten(const std::string& program, const std::string& conditions = "") const {
    std::ofstream(path("part.nc")) << program;
    const auto run = run_program("compensate " + path("model.toml") + " " + path("part.nc") + " -o " +
                                 path("out.nc") + " --work-offset G54=X0,Y0,Z0 --tool-length H1=200" +
                                 (conditions.empty() ? "" : " --conditions " + conditions));
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return content(path("out.nc"));
  }

  /// At 20 degC by default, and at 25; what stands in the header, given back, makes the same file, and is
  /// then stated.
  void expect_header_of_coordinates(const std::string& program, const std::string& begin,
                                    const std::string& end) const {
    const std::string usual = rewritten(program), warm = rewritten(program, "T_air=25");
    EXPECT_THAT(usual,
                HasSubstr("\n" + begin + "conditions: T_air_degC=20 reference temperature" + end + "\n"));
    EXPECT_THAT(usual, ::testing::ContainsRegex("\nG1 X400(\\.0000)? F800\n"));
    EXPECT_THAT(warm, HasSubstr("\n" + begin + "conditions: T_air_degC=25 as stated" + end + "\n"));
    EXPECT_THAT(warm, HasSubstr("G1 X399.9800 F800\n"));
    EXPECT_EQ(rewritten(program, "T_air_degC=25"), warm);
    const std::string assumed = "reference temperature";
    std::string stated = usual;
    stated.replace(stated.find(assumed), assumed.size(), "as stated");
    EXPECT_EQ(rewritten(program, "T_air_degC=20"), stated);
  }

 private:
  testing::ScratchFolder folder_;
};

TEST_F(ConditionsOfPrograms, InTheHeaderAreThoseOfTheCoordinates) {
  write_machine("w X' Y' b Z t", "XYZ");
  const std::string program = "G21 G90 G54\nG0 X0 Y0 Z0\nG1 X400 F800\nM2\n";
  expect_header_of_coordinates(program, "(", ")");
  EXPECT_THAT(rewritten(program, "T_air=25,time_s=60"),
              HasSubstr("(conditions: T_air_degC=25 as stated, time_s=60 as stated)\n"));
}

TEST_F(ConditionsOfPrograms, StandAboveToolCentrePointMotion) {
  write_machine("w C' A' b X Y Z t", "XYZAC");
  expect_header_of_coordinates("G21 G90 G54\nG0 A0 C0\nG43.4 H1\nG0 X0 Y0 Z0\nG1 X400 F800\nG49\nM30\n", "(",
                               ")");
}

/// SINUMERIK takes brackets for parameters.
TEST_F(ConditionsOfPrograms, StandBehindASemicolonWhereBracketsAreNoComment) {
  write_machine("w C' A' b X Y Z t", "XYZAC");
  const std::string program = "G21 G90 G54\nG0 A0 C0\nTRAORI\nG0 X0 Y0 Z0\nG1 X400 F800\nTRAFOOF\nM30\n";
  expect_header_of_coordinates(program, "; ", "");
  const std::string text = rewritten(program);
  EXPECT_THAT(text, ::testing::StartsWith("; volcal compensate: result "));
  std::ofstream(path("once.nc")) << text;
  const auto twice = run_program("compensate " + path("model.toml") + " " + path("once.nc") + " --check" +
                                 " --work-offset G54=X0,Y0,Z0");
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.errors, HasSubstr("has been compensated already"));
}

/// Machines whose only error is one wave or expression of X, with X from -400 to 400 mm and its home at 0.
class ProgramsOfWaves : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream machine(path("machine.toml"));
    machine << "format = \"volcal-machine-1\"\nname = \"waves\"\nstructure = \"w b X Y Z t\"\n"
               "[datum]\nprimary = \"X\"\nsecondary = \"Y\"\n";
    for (const char axis : std::string("XYZ"))
      machine << "[axes." << axis
              << "]\ntravel_mm = [-400, 400]\nhome_mm = 0\nreference_point_mm = [0, 0, 0]\n";
    machine << "[tools.short]\noffset_mm = [0, 0, -150]\n";
    std::ofstream(path("line.ngc")) << "G21 G90 G54 G17\nG0 X-400 Y5 Z0\nG1 X400 F1000\nM2\n";
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  void write_effect(const std::string& effect) const {
    std::ofstream(path("model.toml")) << "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n"
                                         "[functions]\ndefault = { basis = \"zero\" }\n[[effects]]\n"
                                      << effect;
  }
  void write_wave(double period_mm) const {
    write_effect("kind = \"lead-error\"\nsymbol = \"EYX\"\ncos_um = 5.0\nsin_um = 0.0\nperiod_mm = " +
                 std::to_string(period_mm) + "\n");
  }
  auto compensate(const std::string& options) const {
    return run_program("compensate " + path("model.toml") + " " + path("line.ngc") +
                       " --work-offset G54=X0,Y0,Z0 --check --json " + options);
  }
  /// Largest distance in um, along the line of the program, of the written Y from 5 mm less the error.
  double largest_left(const std::function<double(double x_mm)>& error_um) const {
    std::istringstream lines(content(path("out.ngc")));
    double x = 0.0, y = 0.0, largest = 0.0;
    bool feed = false;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("(") || line.starts_with("M") || line.starts_with("G21")) continue;
      double x_to = x, y_to = y;
      std::istringstream words(line);
      for (std::string word; words >> word;) {
        if (word == "G1") feed = true;
        if (word[0] == 'X') x_to = std::stod(word.substr(1));
        if (word[0] == 'Y') y_to = std::stod(word.substr(1));
      }
      const int places = static_cast<int>(std::ceil(std::abs(x_to - x) / 0.0137)) + 3;
      for (int i = 0; feed && i <= places; ++i) {
        const double share = static_cast<double>(i) / places;
        const double at = x + share * (x_to - x);
        largest = std::max(largest, std::abs(1e3 * (y + share * (y_to - y) - 5.0) + error_um(at)));
      }
      x = x_to;
      y = y_to;
    }
    return largest;
  }

 private:
  testing::ScratchFolder folder_;
};

constexpr double kRoundedTolerance_um = 0.55;  // half of 0.1 um is rounded

/// EYX moves the tool by +Y: the command is Y less 5 um cos(2 pi x / period). All periods but one divide the
/// travel, 12.5 mm and 6.25 mm in a power of 2.
TEST_F(ProgramsOfWaves, KeepTheToleranceWhateverThePeriod) {
  for (const double period : {20.0, 12.5, 10.0, 7.3, 6.25, 5.0, 2.0, 0.5}) {
    write_wave(period);
    const auto run = compensate("-o " + path("out.ngc"));
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto error = [period](double x) { return 5.0 * std::cos(2.0 * std::numbers::pi * x / period); };
    EXPECT_LE(largest_left(error), kRoundedTolerance_um) << period << " mm";
    const auto json = nlohmann::json::parse(run.output);
    EXPECT_LE(json.at("check").at("after").at("max_um").get<double>(), kRoundedTolerance_um) << period;
    // A chord of h is h^2 / 8 (2 pi / period)^2 5 um off: at least 3.5 of them a period.
    const double periods = 800.0 / period;
    EXPECT_GE(json.at("lines_written").get<double>(), 3.5 * periods) << period;
    EXPECT_LE(json.at("lines_written").get<double>(), 14.0 * periods) << period;
  }
}

/// Also where the wave is in an expression, shows in one direction alone, or in a part of the other axis.
TEST_F(ProgramsOfWaves, KeepTheToleranceForExpressions) {
  const auto wave = [](double x) { return 5.0 * std::sin(2.0 * std::numbers::pi * x / 20.0); };
  for (const std::string expression :
       {"sin(2 * pi * x / 20)", "sin(2 * pi * x / 20) * sin(2 * pi * y / 20)",
        "(dir_x > 0) * sin(2 * pi * x / 20)", "x * x * 0 + sin(2 * pi * x / 20)"}) {
    write_effect("kind = \"custom\"\ntarget = \"EYX\"\namplitude_um = 5.0\nexpression = \"" + expression +
                 "\"\n");
    const auto run = compensate("-o " + path("out.ngc"));
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_LE(largest_left(wave), kRoundedTolerance_um) << expression;
  }
}

/// A line in one piece from crest to crest: 5 um (cos - 1) are left, by hand 10 um at most and RMS 5 um
/// sqrt(3 / 2); as programmed 5 um and 5 um / sqrt(2).
TEST_F(ProgramsOfWaves, AreCheckedAtAllPhases) {
  std::ofstream(path("line.ngc")) << "G21 G90 G54 G17\nG0 X-40 Y5 Z0\nG1 X40 F1000\nM2\n";
  for (const double period : {20.0, 5.0, 2.0}) {
    write_wave(period);
    const auto run = compensate("--tolerance-um 60");
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    const auto json = nlohmann::json::parse(run.output);
    EXPECT_EQ(json.at("split_lines"), 0);
    const auto& check = json.at("check");
    EXPECT_NEAR(check.at("before").at("rms_um").get<double>(), 5.0 / std::sqrt(2.0), 0.1) << period;
    EXPECT_NEAR(check.at("after").at("rms_um").get<double>(), 5.0 * std::sqrt(1.5), 0.1) << period;
    EXPECT_NEAR(check.at("after").at("max_um").get<double>(), 10.0, 0.1) << period;
  }
}

TEST_F(ProgramsOfWaves, AreRefusedWhereTheyWouldBecomeTooLong) {
  write_wave(0.01);
  const auto run = compensate("-o " + path("out.ngc"));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, HasSubstr("line.ngc:3: the identified errors change in waves so short that the "
                                    "line would become more than 100000 lines within the tolerance"));
  EXPECT_THAT(run.errors, HasSubstr("--tolerance-um"));
  EXPECT_FALSE(std::filesystem::exists(path("out.ngc")));
}

/// A head whose C has a worm error of 4 deg: with B at 0 the tool turns about itself, and C alone is
/// corrected, by -60 urad cos(2 pi C / 4 deg). From 0 to 32 deg every halving of the line meets a crest.
TEST_F(ProgramsOfWaves, KeepTheToleranceForWormsOfRotaryAxes) {
  std::ofstream machine(path("machine.toml"), std::ios::app);
  machine << "[axes.C]\ntravel_deg = [-180, 180]\nhome_deg = 0\ncentre_mm = [0, 0, 150]\n"
             "[axes.B]\ntravel_deg = [-90, 90]\nhome_deg = 0\ncentre_mm = [0, 0, 150]\n";
  machine.close();
  std::string text = content(path("machine.toml"));
  text.replace(text.find("X Y Z t"), 7, "X Y Z C B t");
  std::ofstream(path("machine.toml")) << text;
  write_effect(
      "kind = \"worm-error\"\nsymbol = \"ECC\"\nperiod_deg = 4.0\ncos_urad = 60.0\nsin_urad = 0.0\n");
  std::ofstream(path("line.ngc"))
      << "G21 G90 G54 G17\nG43.4 H1\nG0 X0 Y0 Z0 B0 C0\nG1 X320 C32 F1000\nG49\nM2\n";
  const auto run = compensate("--tool-length H1=150 -o " + path("out.ngc"));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  std::istringstream lines(content(path("out.ngc")));
  double x = 0.0, c = 0.0, largest_urad = 0.0;
  bool feed = false;
  for (std::string line; std::getline(lines, line);) {
    double x_to = x, c_to = c;
    std::istringstream words(line);
    for (std::string word; !line.starts_with("(") && words >> word;) {
      if (word == "G1") feed = true;
      if (word[0] == 'X') x_to = std::stod(word.substr(1));
      if (word[0] == 'C') c_to = std::stod(word.substr(1));
    }
    for (int i = 0; feed && i <= 500; ++i) {
      const double meant = (x + i / 500.0 * (x_to - x)) / 10.0;
      const double off_deg = c + i / 500.0 * (c_to - c) - meant;
      largest_urad = std::max(largest_urad, std::abs(off_deg * std::numbers::pi / 180.0 * 1e6 +
                                                     60.0 * std::cos(std::numbers::pi / 2.0 * meant)));
    }
    x = x_to;
    c = c_to;
  }
  EXPECT_LE(largest_urad, 5.0 + 0.2) << "0.5 um at 100 mm, and half of 1e-5 deg";
}

/// Beyond its bounds an expression is refused; without readings what is not finite states the pose.
TEST_F(ProgramsOfWaves, RefuseExpressionsWithoutBoundsOrValues) {
  const auto tables = [this](const std::string& expression) {
    write_effect("kind = \"custom\"\ntarget = \"EYX\"\namplitude_um = 1\nexpression = \"" + expression +
                 "\"\n");
    const auto run = run_program("tables " + path("model.toml") + " --at X=-10");
    EXPECT_EQ(run.exit_code, 2);
    return run.errors;
  };
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '(') + "x" + std::string(depth, ')');
  };
  EXPECT_THAT(tables(nested(20000)), HasSubstr("model.toml:5: effect \"custom\": the expression \"((("));
  EXPECT_THAT(tables(nested(20000)), HasSubstr("it is longer than 4000 characters; write a shorter one"));
  EXPECT_LT(tables(nested(20000)).size(), 1000U);
  EXPECT_THAT(tables(nested(101)),
              HasSubstr("nested more than 100 deep; write it with fewer, at character 101"));
  EXPECT_THAT(tables("sqrt(-1 - x * x)"), HasSubstr("is not finite at the pose X"));
  write_effect("kind = \"custom\"\ntarget = \"EYX\"\namplitude_um = 1\nexpression = \"" + nested(100) +
               "\"\n");
  EXPECT_EQ(run_program("tables " + path("model.toml") + " --at X=-10").exit_code, 0);
}

/// docs/guides/compensate-a-program.md shows a command and what it prints, line by line.
TEST(CompensateGuide, QuotesWhatTheProgramPrints) {
  const std::filesystem::path source = VOLCAL_SOURCE_DIR;
  const testing::ScratchFolder scratch;
  const std::string result = (scratch.path() / "result").string(),
                    out = (scratch.path() / "pocket.ngc").string();
  const std::string demo = (source / "datasets/demo/campaign").string();
  ASSERT_EQ(
      run_program("fit " + demo + "/campaign.toml --model " + demo + "/model.toml -o " + result).exit_code,
      0);
  const std::string options = " -o " + out + " --check --work-offset G54=X10,Y-20,Z-350 --tool-length H1=150";
  const auto run = run_program("compensate " + result + " " +
                               (source / "tests/data/programs/pocket.ngc").string() + options);
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  std::string printed = run.output;
  ASSERT_TRUE(printed.ends_with(out + "\n"));
  printed.replace(printed.size() - out.size() - 1, out.size(), "out/demo/pocket.ngc");
  EXPECT_THAT(content(source / "docs/guides/compensate-a-program.md"),
              HasSubstr("```\n" + printed + "```\n"));
}

}  // namespace
}  // namespace volcal
