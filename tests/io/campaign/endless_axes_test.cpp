/// Which rotary axes turn without end, as machine files say it and as what is written of a machine keeps it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/refusal.h"
#include "tests/support/rotary_machines.h"
#include "volcal/identify/compensation/csv_tables.h"
#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/io/campaign/toml_writer.h"
#include "volcal/identify/io/results/result_json_parts.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A table C and a head A that travels a turn.
std::string lathe_with_head(const std::string& of_c) {
  return "format = \"volcal-machine-1\"\nstructure = \"w C' b Z A t\"\n[axes.Z]\ntravel_mm = [0, "
         "500]\nhome_mm "
         "= 0\n[axes.A]\ntravel_deg = [-180, 180]\nhome_deg = 0\n[axes.C]\nhome_deg = 0\n" +
         of_c;
}

Machine with_c(const std::string& of_c) { return parse_machine(lathe_with_head(of_c), "machine.toml"); }

/// C of a table is stated to stop, C of a head to turn on.
FitResult result_against_the_usual(const std::string& structure) {
  FitResult result = testing::rotary_result(structure);
  for (Axis& axis : result.machine.axes) {
    if (axis.name == AxisName::C) axis.endless = structure != testing::kTrunnion;
  }
  return result;
}

TEST(EndlessAxes, AreTablesThatTravelATurn) {
  const Machine machine = with_c("travel_deg = [-180, 180]\n");
  EXPECT_TRUE(machine.is_endless(AxisName::C));
  EXPECT_FALSE(machine.is_endless(AxisName::A)) << "the tool's side";
  EXPECT_FALSE(machine.is_endless(AxisName::Z));
  EXPECT_THAT(machine_toml(machine), Not(HasSubstr("endless")));
  EXPECT_FALSE(with_c("travel_deg = [-90, 90]\n").is_endless(AxisName::C));
}

TEST(EndlessAxes, AreWhatTheMachineFileSays) {
  Machine machine = with_c("travel_deg = [-180, 180]\nendless = false\n");
  EXPECT_FALSE(machine.is_endless(AxisName::C));
  for (Axis& axis : machine.axes) {
    if (axis.name == AxisName::A) axis.endless = true;
  }
  const Machine again = parse_machine(machine_toml(machine), "machine.toml");
  EXPECT_FALSE(again.is_endless(AxisName::C));
  EXPECT_TRUE(again.is_endless(AxisName::A));
}

TEST(EndlessAxes, AreRefusedWhereTheyCannotBe) {
  const auto refused = [](const std::string& text) {
    return testing::refusal([&] { parse_machine(text, "machine.toml"); });
  };
  EXPECT_THAT(refused(lathe_with_head("travel_deg = [-90, 90]\nendless = true\n")),
              HasSubstr("machine.toml:12: axes.C.endless is true and travel_deg less than a turn"));
  EXPECT_THAT(refused(lathe_with_head("travel_deg = [-180, 180]\nendless = 1\n")),
              HasSubstr("true or false"));
  std::string linear = lathe_with_head("travel_deg = [-180, 180]\n");
  linear.replace(linear.find("home_mm = 0"), 11, "home_mm = 0\nendless = true");
  EXPECT_THAT(refused(linear), HasSubstr("unknown key axes.Z.endless"));
}

TEST(EndlessAxes, AreKeptInResultsAndTables) {
  for (const char* structure : {testing::kTrunnion, testing::kHead}) {
    const FitResult result = result_against_the_usual(structure);
    const bool endless = structure != std::string(testing::kTrunnion);
    const Machine read = json_parts::machine_from(json_parts::machine(result.machine));
    EXPECT_EQ(read.is_endless(AxisName::C), endless) << structure;
    const TableMetadata tables = read_table_metadata({"metadata.csv", table_metadata_csv(result, {})});
    EXPECT_EQ(tables.machine.is_endless(AxisName::C), endless) << structure;
    std::string damaged = table_metadata_csv(result, {});
    const std::string row = std::string("axis.C.endless,") + (endless ? "yes" : "no");
    ASSERT_NE(damaged.find(row), std::string::npos);
    damaged.replace(damaged.find(row), row.size(), "axis.C.endless,perhaps");
    EXPECT_THAT(testing::refusal([&] {
                  read_table_metadata({"metadata.csv", damaged});
                }),
                HasSubstr("write yes or no"));
  }
}

}  // namespace
}  // namespace volcal
