/// Mills whose error functions are all missing, counted by the program; docs/studies.md has the full count.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tests/support/long_tests.h"
#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/study_campaigns.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using testing::run_program;

nlohmann::json mills(const std::string& options) { return testing::campaigns_of_study("mills", options); }

/// One mill in every run, at night eight: most of what is hidden comes back, and other poses are predicted.
TEST(MillsStudy, ErrorFunctionsComeBack) {
  for (const auto& mill : mills(testing::long_tests() ? "-n 8 --seed 21" : "-n 1 --seed 24")) {
    const auto hidden = mill.at("hidden").get<std::set<std::string>>();
    const auto found = mill.at("found").get<std::set<std::string>>();
    EXPECT_TRUE(std::ranges::includes(hidden, found)) << mill.dump();
    EXPECT_GE(2 * found.size(), hidden.size()) << mill.dump();
    for (const std::string other : mill.at("other_functions")) EXPECT_FALSE(hidden.contains(other)) << other;
    EXPECT_LT(mill.at("offered_um").get<double>(), 0.3 * mill.at("given_um").get<double>()) << mill.dump();
  }
}

/// The effect does better than any one of the error functions that are missing, and not beside all of them.
TEST(MillsStudy, NoEffectIsNamedThatMissingErrorFunctionsMayHold) {
  const auto alone = mills("-n 1 --seed 24 --without open-errors");
  EXPECT_FALSE(alone.at(0).at("wrong_effects").empty()) << "another mill tells what is tested here";
  const auto beside = mills("-n 1 --seed 24");
  EXPECT_TRUE(beside.at(0).at("wrong_effects").empty()) << beside.dump();
}

/// What is finished is not run again, and another seed is refused.
TEST(MillsStudy, GoesOnWhereItWasInterrupted) {
  const testing::ScratchFolder scratch;
  const std::string folder = (scratch.path() / "kept").string();
  const auto one = mills("-n 1 --seed 24 -o " + folder);
  EXPECT_EQ(mills("-n 1 --seed 24 --resume -o " + folder), one);
  EXPECT_THAT(run_program("study mills -n 1 --seed 24 -o " + folder).errors, HasSubstr("--resume"));
  EXPECT_THAT(run_program("study mills -n 1 --seed 99 --resume -o " + folder).errors,
              HasSubstr("another seed"));
}

}  // namespace
}  // namespace volcal
