// What the program says to a command line that it cannot take.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "tests/support/program.h"

namespace volcal {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::content;
using ::testing::HasSubstr;
using testing::run_program;
using ::testing::StartsWith;

void expect_refusal(const std::string& arguments, const std::string& problem, const std::string& remedy) {
  const auto run = run_program(arguments);
  EXPECT_EQ(run.exit_code, 2) << arguments;
  EXPECT_EQ(run.output, "");
  EXPECT_THAT(run.errors, AllOf(HasSubstr(problem), HasSubstr(remedy)));
}

TEST(CommandLine, NamesTheNearestCommand) {
  expect_refusal("simulat study.toml", "there is no command \"simulat\"", "did you mean \"simulate\"?");
}

TEST(CommandLine, ListsTheCommandsWhenNoneIsNear) {
  expect_refusal("nosuch", "there is no command \"nosuch\"", "known commands: init, import, simulate, fit");
}

TEST(CommandLine, AsksForACommand) { expect_refusal("", "subcommand is required", "volcal --help"); }

TEST(CommandLine, NamesAnUnknownOption) {
  expect_refusal("fit campaign.toml --output out --no-such-option", "--no-such-option",
                 "volcal COMMAND --help");
}

TEST(CommandLine, NamesTheNearestOption) {
  expect_refusal("fit campaign.toml --modle model.toml -o out", "there is no option \"--modle\"",
                 "did you mean \"--model\"?");
  expect_refusal("fit campaign.toml --noize=white", "there is no option \"--noize\"",
                 "did you mean \"--noise\"?");
}

TEST(CommandLine, NamesTheNearestStudy) {
  expect_refusal("study closed-lop -n 3", "there is no command \"study closed-lop\"",
                 "did you mean \"closed-loop\"?");
}

TEST(CommandLine, SaysInWordsWhichNumbersItTakes) {
  expect_refusal("fit campaign.toml -o out --threads -1", "--threads: -1 must not be negative", "volcal");
  expect_refusal("fit campaign.toml -o out --threads many", "--threads: \"many\" is not a number", "volcal");
  expect_refusal("validate result campaign.toml --max-rms-um -3", "--max-rms-um: -3 must be positive",
                 "volcal");
  expect_refusal("validate result campaign.toml --max-rms-um nan", "\"nan\" is not a number", "volcal");
  expect_refusal("study closed-loop -n 0", "--campaigns: 0 must be positive", "volcal");
  expect_refusal("compare campaign.toml result --worst -1", "--worst: -1 must not be negative", "volcal");
  expect_refusal("extend model.toml --diagnosis d --rank 0", "--rank: 0 must be positive", "volcal");
  expect_refusal("simulate study.toml -o out --seed -1", "--seed: -1 must not be negative", "volcal");
  expect_refusal("study closed-loop --seed -1", "--seed: -1 must not be negative", "volcal");
}

TEST(CommandLine, CallsItselfVolcalWhereverItIs) {
  EXPECT_THAT(run_program("--help").output, HasSubstr("Usage: volcal [OPTIONS]"));
  EXPECT_THAT(run_program("fit --help").output, HasSubstr("Usage: volcal fit [OPTIONS] CAMPAIGN"));
  EXPECT_THAT(run_program("study").errors, HasSubstr("Usage: volcal study [OPTIONS]"));
}

TEST(CommandLine, SaysWhatIsMissingAndWhatToGive) {
  const testing::ScratchFolder scratch;
  fs::create_directory(scratch.path() / "result");
  const std::string here = scratch.path().string() + "/";
  const std::string campaign = std::string(VOLCAL_SOURCE_DIR) + "/tests/data/small/campaign.toml";
  const auto refusal = [](const std::string& arguments) {
    const auto run = run_program(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    return run.errors;
  };
  EXPECT_EQ(refusal("validate " + here + "nowhere " + campaign),
            "error: " + here +
                "nowhere: there is no such result (give the folder that volcal fit wrote with -o)\n");
  EXPECT_EQ(refusal("validate " + here + "resul " + campaign),
            "error: " + here + "resul: there is no such result (did you mean \"result\"?)\n");
  EXPECT_EQ(refusal("compare " + campaign + " " + here + "resul"),
            "error: " + here + "resul: there is no such result or model (did you mean \"result\"?)\n");
  EXPECT_EQ(refusal("compare " + campaign + " " + here + "nowhere"),
            "error: " + here +
                "nowhere: there is no such result or model (give a result folder of volcal fit, a "
                "model.toml, a folder of tables "
                "--format csv, or the word nominal)\n");
  EXPECT_EQ(refusal("diagnose --show " + here + "nowhere"),
            "error: " + here +
                "nowhere: there is no such diagnosis (give the folder that volcal diagnose wrote with -o)\n");
  EXPECT_EQ(
      refusal("fit " + here + "nowhere.toml -o " + here + "out"),
      "error: " + here +
          "nowhere.toml: the file does not exist (give its path; it is relative to the folder you are in)\n");
}

TEST(CommandLine, NamesTheOutputThatCannotBeWritten) {
  const auto run = run_program("init \"w X' b Y Z t\" -o /proc/my-machine");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.errors, StartsWith("error: /proc/my-machine: creating the folder failed"));
}

TEST(CommandLine, RefusesAnOutputBeforeTheWork) {
  const testing::ScratchFolder scratch;
  fs::create_directory(scratch.path() / "thesis");
  std::ofstream(scratch.path() / "thesis" / "text.tex") << "years of work";
  for (const char* command : {"fit", "diagnose", "compare"}) {
    const std::string model = command == std::string("compare") ? " nominal" : "";
    const auto run = run_program(std::string(command) + " no-campaign.toml" + model + " -o " +
                                 (scratch.path() / "thesis").string());
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.errors, HasSubstr("holds files that volcal did not write")) << command;
  }
}

/// Replacing the folder would delete what is read.
TEST(CommandLine, RefusesAnOutputThatHoldsItsInput) {
  const testing::ScratchFolder scratch;
  const std::string folder = (scratch.path() / "measured").string();
  const std::string machine = VOLCAL_SOURCE_DIR "/datasets/demo/machine.toml";
  std::ofstream(scratch.path() / "study.toml")
      << "format = \"volcal-study-1\"\nmachine = \"" << machine
      << "\"\n[[measurements]]\nkind = \"laser-tracer\"\ngrid = [2, 2, 2]\n";
  ASSERT_EQ(run_program("simulate " + (scratch.path() / "study.toml").string() + " -o " + folder).exit_code,
            0);
  for (const std::string command : {"fit CAMPAIGN", "montecarlo CAMPAIGN", "diagnose CAMPAIGN",
                                    "compare CAMPAIGN nominal", "plan MACHINE --readings 100"}) {
    std::string words = command;
    for (const auto& [name, file] : {std::pair("CAMPAIGN", "/campaign.toml"), {"MACHINE", "/machine.toml"}}) {
      if (const auto at = words.find(name); at != std::string::npos)
        words.replace(at, std::string(name).size(), folder + file);
    }
    const auto run = run_program(words + " -o " + folder);
    EXPECT_EQ(run.exit_code, 2) << command;
    EXPECT_THAT(run.errors, HasSubstr("which is read")) << command;
  }
  for (const std::string command : {"tables ", "align "}) {
    const auto run = run_program(command + folder + " -o " + folder + "/");
    EXPECT_EQ(run.exit_code, 2) << command;
    EXPECT_THAT(run.errors, HasSubstr("which is read")) << command;
  }
  EXPECT_TRUE(fs::exists(folder + "/campaign.toml"));
}

TEST(Init, LeavesEditedFilesAlone) {
  const testing::ScratchFolder scratch;
  const fs::path folder = scratch.path() / "machine";
  const std::string init = "init \"w X' b Y Z t\" -o " + folder.string();
  ASSERT_EQ(run_program(init).exit_code, 0);
  std::ofstream(folder / "machine.toml", std::ios::app) << "# measured by hand\n";
  const auto again = run_program(init);
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.errors, HasSubstr("name another folder"));
  EXPECT_THAT(content(folder / "machine.toml"), HasSubstr("measured by hand"));
}

TEST(Init, PrintsJson) {
  const testing::ScratchFolder scratch;
  const std::string folder = (scratch.path() / "machine").string();
  const auto run = run_program("init \"w X' b Y Z t\" --json -o " + folder);
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const auto json = nlohmann::json::parse(run.output);
  EXPECT_EQ(json["folder"], folder);
  EXPECT_EQ(json["files"].size(), 3U);
}

/// The line and what to do, not only that something of the setup is far off.
TEST(Fit, NamesTheReadingThatIsFarOff) {
  const testing::ScratchFolder scratch;
  const fs::path folder = scratch.path() / "campaign";
  fs::copy(fs::path(VOLCAL_SOURCE_DIR) / "tests/data/small", folder);
  std::string diagonal = content(folder / "diagonal.csv");
  diagonal.replace(diagonal.find("142.4218"), 8, "442.4218");
  std::ofstream(folder / "diagonal.csv") << diagonal;
  expect_refusal("fit " + (folder / "campaign.toml").string() + " -o " + (scratch.path() / "out").string(),
                 "diagonal.csv:4: setup \"diagonal\": its readings miss the nominal machine",
                 "leave it out with leave_out = [{ rows = [4], reason");
}

TEST(CommandLine, EveryCommandKnowsJson) {
  for (const char* command : {"init", "simulate", "fit", "compare", "validate", "montecarlo", "plan",
                              "diagnose", "extend", "align", "tables", "compensate"})
    EXPECT_THAT(run_program(std::string(command) + " --help").output, HasSubstr("--json")) << command;
}

TEST(Extend, PrintsJson) {
  const testing::ScratchFolder scratch;
  const std::string model = (scratch.path() / "model.toml").string();
  std::ofstream(model) << "format = \"volcal-model-1\"\nmachine = \"" VOLCAL_SOURCE_DIR
                          "/datasets/demo/machine.toml\"\n[functions]\n";
  const auto run = run_program("extend " + model + " --effect reversal:EXX --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_EQ(nlohmann::json::parse(run.output)["effects"], 1);
}

TEST(Init, NamesTheColumnsOfTheMachine) {
  const testing::ScratchFolder scratch;
  const fs::path three = scratch.path() / "three", five = scratch.path() / "five";
  ASSERT_EQ(run_program("init \"w X' b Y Z t\" -o " + three.string()).exit_code, 0);
  ASSERT_EQ(run_program("init \"w C' A' b X Y Z t\" -o " + five.string()).exit_code, 0);
  EXPECT_THAT(content(three / "campaign.toml"), HasSubstr("columns: x_mm,y_mm,z_mm,length_mm\n"));
  EXPECT_THAT(content(five / "campaign.toml"), HasSubstr("columns: x_mm,y_mm,z_mm,a_deg,c_deg,length_mm\n"));
}

TEST(Init, ItsCampaignAsksForASetup) {
  const testing::ScratchFolder scratch;
  const std::string folder = (scratch.path() / "machine").string();
  ASSERT_EQ(run_program("init \"w X' b Y Z t\" -o " + folder).exit_code, 0);
  expect_refusal("fit " + folder + "/campaign.toml -o " + folder + "/result", "key setups is missing",
                 "take the comment marks off one");
}

TEST(CommandLine, NamesAMissingArgument) { expect_refusal("fit", "required", "volcal COMMAND --help"); }

}  // namespace
}  // namespace volcal
