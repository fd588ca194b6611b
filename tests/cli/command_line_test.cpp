// What the program says to a command line that it cannot take.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

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
  expect_refusal("nosuch", "there is no command \"nosuch\"", "known commands: init, simulate, fit");
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
  EXPECT_EQ(
      refusal("compare " + campaign + " " + here + "nowhere"),
      "error: " + here +
          "nowhere: there is no such result or model (give a result folder of volcal fit, a model.toml, or "
          "the word nominal)\n");
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
