/// NC programs rewritten from the command line, for a machine that the program itself has identified.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
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
      {out + " --work-offset G54=X0,Y0,Zten", "\"ten\" is no length in mm"},
      {out + " --work-offset G53=X0,Y0,Z0", "--work-offset G53 is no work offset"},
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

  /// At 20 degC by default, and at 25; what stands in the header, given back, makes the same file.
  void expect_header_of_coordinates(const std::string& program, const std::string& begin,
                                    const std::string& end) const {
    const std::string usual = rewritten(program), warm = rewritten(program, "T_air=25");
    EXPECT_THAT(usual,
                HasSubstr("\n" + begin + "conditions: T_air_degC=20 reference temperature" + end + "\n"));
    EXPECT_THAT(usual, ::testing::ContainsRegex("\nG1 X400(\\.0000)? F800\n"));
    EXPECT_THAT(warm, HasSubstr("\n" + begin + "conditions: T_air_degC=25 as stated" + end + "\n"));
    EXPECT_THAT(warm, HasSubstr("G1 X399.9800 F800\n"));
    EXPECT_EQ(rewritten(program, "T_air_degC=25"), warm);
    EXPECT_EQ(rewritten(program, "T_air_degC=20"), usual);
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
