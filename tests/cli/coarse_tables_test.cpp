/// Tables whose positions are further apart than the errors change.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/program.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_program;

/// A model of straightness of X with the pitch of a 20 mm screw, 5 um; its path.
std::string model_of_a_screw(const testing::ScratchFolder& scratch) {
  const std::string folder = scratch.path().string() + "/m";
  EXPECT_EQ(run_program("init \"w X' b Y Z t\" -o " + folder).exit_code, 0);
  std::ofstream(folder + "/screw.toml")
      << "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n[functions]\ndefault = { basis = \"zero\" "
         "}\n"
      << "[[effects]]\nkind = \"lead-error\"\nsymbol = \"EYX\"\nperiod_mm = 20\ncos_um = 5.0\nsin_um = 0.0\n";
  return folder + "/screw.toml";
}

/// A grid of 50 mm takes its values at random phases and adds to it, one of 2 mm takes it away.
TEST(CoarseTables, AreNotToBeLoaded) {
  const testing::ScratchFolder scratch;
  const std::string tables = "tables " + model_of_a_screw(scratch) + " --dry-run --format ";
  const auto coarse = run_program(tables + "linuxcnc-grid --step 47");
  EXPECT_THAT(coarse.output, HasSubstr(" with these tables and by 3.53 without: do not load them"));
  const nlohmann::json json =
      nlohmann::json::parse(run_program(tables + "linuxcnc-grid --step 47 --json").output);
  ASSERT_EQ(json.at("cautions_findings").size(), 2);
  EXPECT_EQ(json.at("cautions_findings").at(0).at("code"), "compensation.tables-off-ideal");
  EXPECT_EQ(json.at("cautions_findings").at(1).at("code"), "compensation.tables-leave-more");
  const auto fine = run_program(tables + "csv --positions 601");
  EXPECT_THAT(fine.output, Not(HasSubstr("do not load")));
  EXPECT_THAT(fine.output, Not(HasSubstr("off the ideal")));
}

/// Positions of a csv folder are its own where nothing is said, and follow a tolerance.
TEST(CoarseTables, OfAFolderAskForATolerance) {
  const testing::ScratchFolder scratch;
  const std::string tables = "tables " + model_of_a_screw(scratch) + " --dry-run --format csv";
  EXPECT_THAT(run_program(tables).output, HasSubstr("off the ideal compensation: --tolerance takes as many"));
  EXPECT_THAT(run_program(tables + " --tolerance 0.5").output, Not(HasSubstr("--tolerance takes")));
}

}  // namespace
}  // namespace volcal
