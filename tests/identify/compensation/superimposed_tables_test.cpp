// New tables in place of tables that were active while the machine was measured (ISO/TR 16907:2015, 10.5).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "volcal/identify/compensation/checks/volume_check.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

/// What is left with the active tables: EXX = 10 um/m x.
FitResult measured_again() {
  Machine machine = testing_support::machine_of("w X' b Y Z t");
  machine.tools = {{"short", Eigen::Vector3d::Zero(), 0.0}};
  return testing::result_with(machine, {.functions = {{"EXX", [](double q) { return 10e-6 * q; }}}}, 2);
}

/// Added to the command of `output` at X = 1 m: `value`; by 2 um more approached towards -.
CompensationTables active_tables(AxisName output, double value) {
  CompensationTables tables;
  tables.terms.push_back(axis_term(output, {.input = AxisName::X,
                                            .position = {0.0, 1.0},
                                            .forward = {0.0, value},
                                            .backward = {2e-6, value + 2e-6}}));
  return tables;
}

TableFormatOptions superimposed(const char* type, const CompensationTables& active) {
  TableFormatOptions options;
  options.type = CompensationType::parse(type);
  options.step = 0.5;
  options.active = active;
  return options;
}

// The active tables add -5 um at 1 m and the machine still goes 10 um too far: -15 um.
TEST(SuperimposedTables, CorrectWhatWasActiveAndWhatWasFound) {
  const TableFormat& format = *find_table_format("neutral-csv");
  const auto files =
      write_tables(format, measured_again(), superimposed("L-POS", active_tables(AxisName::X, -5e-6)));
  EXPECT_THAT(file_named(files, "axis_corrections.csv").content, HasSubstr("X,X,1000,-15,-13\n"));
}

TEST(SuperimposedTables, AreJudgedAgainstTheMachineAsItWasMeasured) {
  const TableFormat& format = *find_table_format("neutral-csv");
  const FitResult result = measured_again();
  const TableFormatOptions options = superimposed("L-POS", active_tables(AxisName::X, -5e-6));
  const VolumeCheck check =
      check_in_volume(result, options, format.read(write_tables(format, result, options)));
  // 10 um/m over 1 m: about its middle the mean square is (10 um)^2 / 12, the largest half of 10 um, at an
  // end.
  EXPECT_NEAR(check.before.rms, 10e-6 / std::sqrt(12.0), 0.01e-6);
  EXPECT_NEAR(check.before.max, 5e-6, 0.1e-6);  // about the mean of the places
  EXPECT_NEAR(check.exported.rms, 0.0, 1e-10);
}

std::string refused_tables(const char* format, const TableFormatOptions& options) {
  try {
    write_tables(*find_table_format(format), measured_again(), options);
  } catch (const InputError& error) {
    EXPECT_FALSE(error.remedy().empty());
    return error.what();
  }
  return "";
}

TEST(SuperimposedTables, LoseNothingThatWasActive) {
  const CompensationTables straightness = active_tables(AxisName::Y, -5e-6);
  EXPECT_THAT(refused_tables("neutral-csv", superimposed("L-POS", straightness)),
              HasSubstr("um that L-POS does not hold"));
  EXPECT_EQ(refused_tables("neutral-csv", superimposed("L-VOL", straightness)), "");
  EXPECT_THAT(refused_tables("csv", superimposed("L-VOL", straightness)),
              HasSubstr("csv cannot be superimposed"));
}

}  // namespace
}  // namespace volcal
