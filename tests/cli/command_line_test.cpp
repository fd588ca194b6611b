// What the program says to a command line that it cannot take.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace volcal {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::run_program;

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

TEST(CommandLine, NamesAMissingArgument) { expect_refusal("fit", "required", "volcal COMMAND --help"); }

}  // namespace
}  // namespace volcal
