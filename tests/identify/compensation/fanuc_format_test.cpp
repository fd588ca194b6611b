// FANUC stored pitch error compensation against the example of a parameter manual and by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/model/description/errors.h"
#include "volcal/studies/files/control_tables.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using Settings = std::map<std::string, std::string>;

const TableFormat& fanuc() { return *find_table_format("fanuc"); }

/// Added to the command of X, um, as the format's own reader and the simulated control say.
double fanuc_added_by_both(const std::vector<TableFile>& files, double x, int direction = 1) {
  sim::MachineState state;
  state.position = {x, 0.5, 0.5};
  state.direction.fill(static_cast<std::int8_t>(direction));
  const Eigen::Vector3d own = fanuc().read(files).correction(state.position, state.direction).linear;
  const auto control = sim::command_correction({control_tables(fanuc(), files), 0.0, {}});
  EXPECT_LT((own - control(state).linear).norm(), 1e-12) << "at " << x;
  return own.x() / 1e-6;
}

std::vector<TableFile> write_fanuc(const FitResult& result, double step, const Settings& settings) {
  TableFormatOptions options;
  options.type = CompensationPart::Positioning;
  options.step = step;
  options.settings = {{"sign", "compensation"}, {"output", "even"}};
  for (const auto& [name, value] : settings) options.settings[name] = value;
  return write_tables(fanuc(), result, options);
}

std::string text_of(const std::vector<TableFile>& files) {
  return file_named(files, "pitch_error.txt").content;
}

/// Compensations of X in um at the ends of `pieces` equal pieces from -0.4 m to `end`.
FitResult machine_that_needs(const std::vector<double>& compensations_um, double end) {
  Machine machine = testing_support::machine_of("w X' b Y Z t");
  machine.axes[0].travel_min = -0.4;
  machine.axes[0].travel_max = end;
  const double piece = (end + 0.4) / static_cast<double>(compensations_um.size() - 1);
  const auto error = [=](double q) {
    return -1e-6 * compensations_um[static_cast<std::size_t>(std::lround((q + 0.4) / piece))];
  };
  return testing::result_with(machine, {.functions = {{"EXX", error}}},
                              static_cast<int>(compensations_um.size()) - 1);
}

// Series 0i-PB Parameter Manual B-63980EN/01, page 100, example 1: reference position at point 40, points 50
// mm apart, values of points 33 to 49. Their sums to the right of the reference position, and what is taken
// off to the left of it, are the amounts.
constexpr std::array<int, 17> kExampleValues = {2, 1, 1, -2, 0, -1, 0, -1, 2, 1, 0, -1, -1, -2, 0, 1, 2};
const std::vector<double> kExampleAmounts = {0, 2, 3, 4, 2, 2, 1, 1, 0, 2, 3, 3, 2, 1, -1, -1, 0, 2};

std::string example_values() {
  std::string rows;
  for (std::size_t i = 0; i < kExampleValues.size(); ++i)
    rows += std::to_string(33 + i) + " " + std::to_string(kExampleValues[i]) + "\n";
  return rows;
}

TEST(FanucTables, AmountsAreThoseOfTheExample) {
  const std::vector<TableFile> files = {
      {"pitch_error.txt",
       "VALUES COMPENSATIONS\nOUTPUT EVEN\nDETECTION_UNIT_UM 1\nLARGEST_VALUE 7\nPARAMETER AXIS VALUE\n"
       "REFERENCE X 0\n3605#0 X 0\n3620 X 40\n3621 X 33\n3622 X 49\n3623 X 1\n3624 X 50\nNUMBER VALUE\n" +
           example_values()}};
  for (std::size_t i = 0; i < kExampleAmounts.size(); ++i)
    EXPECT_NEAR(fanuc_added_by_both(files, -0.4 + 0.05 * static_cast<double>(i)), kExampleAmounts[i], 1e-9);
  EXPECT_NEAR(fanuc_added_by_both(files, 0.025), 1.0, 1e-9) << "spread over the interval";
}

TEST(FanucTables, ValuesAreThoseOfTheExample) {
  const auto files = write_fanuc(machine_that_needs(kExampleAmounts, 0.45), 0.05, {{"first_number", "32"}});
  EXPECT_THAT(text_of(files),
              HasSubstr("3605#0 X 0\n3620 X 40\n3621 X 32\n3622 X 49\n3623 X 1\n3624 X 50.0000\n"));
  EXPECT_THAT(text_of(files), HasSubstr("NUMBER VALUE\n32 0\n" + example_values()));
}

/// 0.4 um an interval: 0 0.4 0.8 1.2 1.6 2.0 um are rounded to 0 0 1 1 2 2, and those have differences.
TEST(FanucTables, SumsAreRoundedNotDifferences) {
  const auto files = write_fanuc(machine_that_needs({0.0, 0.4, 0.8, 1.2, 1.6, 2.0}, 0.6), 0.2, {});
  // reference at the third point: 0.8 um is taken off everywhere, -0.8 -0.4 0 0.4 0.8 1.2
  EXPECT_THAT(text_of(files), HasSubstr("NUMBER VALUE\n0 0\n1 1\n2 0\n3 0\n4 1\n5 0\n"));
  EXPECT_NEAR(fanuc_added_by_both(files, 0.6), 1.0, 1e-9);
}

/// 20 um an interval are 6.67 steps of 3 um, 10 of 2 um.
TEST(FanucTables, MagnificationIsTheSmallestThatTheValuesFit) {
  const FitResult result = machine_that_needs({0.0, 20.0, 40.0}, 0.4);
  const auto files = write_fanuc(result, 0.4, {});
  EXPECT_THAT(text_of(files), HasSubstr("3623 X 3\n"));
  EXPECT_THAT(text_of(files), HasSubstr("NUMBER VALUE\n0 0\n1 7\n2 7\n"));
  EXPECT_NEAR(fanuc_added_by_both(files, 0.4), 21.0, 1e-9);
  EXPECT_THAT(text_of(write_fanuc(result, 0.4, {{"largest_value", "127"}})), HasSubstr("3623 X 1\n"));
  EXPECT_THAT(text_of(write_fanuc(result, 0.4, {{"detection_unit_um", "10"}})),
              HasSubstr("3623 X 1\n3624 X 400.0000\n"));
  EXPECT_THROW(write_fanuc(result, 0.4, {{"detection_unit_um", "0.01"}, {"largest_value", "7"}}), InputError);
}

/// X goes 10 um too far at 1 m; towards - it is 4 um less.
FitResult with_reversal() {
  return testing::result_with(
      testing_support::machine_of("w X' b Y Z t"),
      {.functions = {{"EXX", [](double q) { return 10e-6 * q; }}}, .reversals = {{"EXX", 4e-6}}}, 10);
}

TEST(FanucTables, BothDirectionsHaveParametersAndValuesOfTheirOwn) {
  const auto files = write_fanuc(with_reversal(), 0.5, {{"reference_amount", "negative"}});
  EXPECT_THAT(text_of(files), HasSubstr("REFERENCE X 0.0000\n3605#0 X 1\n3620 X 0\n3621 X 0\n3622 X 2\n"
                                        "3623 X 1\n3624 X 500.0000\n3626 X 3\n3627 X 4\n"));
  EXPECT_THAT(text_of(files), HasSubstr("NUMBER VALUE\n0 0\n1 -5\n2 -5\n3 0\n4 -5\n5 -5\n6 0\n"));
  EXPECT_NEAR(fanuc_added_by_both(files, 1.0, 1), -10.0, 1e-9);
  EXPECT_NEAR(fanuc_added_by_both(files, 1.0, -1), -6.0, 1e-9);
  EXPECT_NEAR(fanuc_added_by_both(files, 0.0, -1), 4.0, 1e-9);
}

/// With 3627 for travel towards + the amount towards - is 0 at the reference position.
TEST(FanucTables, ReferenceAmountOfTheOtherDirection) {
  const auto files = write_fanuc(with_reversal(), 0.5, {{"reference_amount", "positive"}});
  EXPECT_THAT(text_of(files), HasSubstr("3627 X -4\n"));
  EXPECT_NEAR(fanuc_added_by_both(files, 1.0, 1), -14.0, 1e-9);
  EXPECT_NEAR(fanuc_added_by_both(files, 1.0, -1), -10.0, 1e-9);
}

TEST(FanucTables, OneDirectionHoldsTheMean) {
  const auto files = write_fanuc(with_reversal(), 0.5, {{"directions", "mean"}});
  EXPECT_THAT(text_of(files), HasSubstr("3605#0 X 0\n"));
  EXPECT_THAT(text_of(files), ::testing::Not(HasSubstr("3627")));
  EXPECT_NEAR(fanuc_added_by_both(files, 1.0, -1), -10.0, 1e-9);
}

TEST(FanucTables, InTheMiddleOfAnIntervalTheWholeValueIsPutOut) {
  const auto files = write_fanuc(with_reversal(), 0.5, {{"output", "middle"}, {"directions", "mean"}});
  EXPECT_NEAR(fanuc_added_by_both(files, 0.24), 0.0, 1e-9);
  EXPECT_NEAR(fanuc_added_by_both(files, 0.26), -5.0, 1e-9);
  EXPECT_NEAR(fanuc_added_by_both(files, 0.74), -5.0, 1e-9);
  EXPECT_NEAR(fanuc_added_by_both(files, 0.76), -10.0, 1e-9);
}

TEST(FanucTables, ErrorsInPlaceOfCompensations) {
  const auto files = write_fanuc(with_reversal(), 0.5, {{"sign", "error"}, {"reference_amount", "negative"}});
  EXPECT_THAT(text_of(files), HasSubstr("VALUES ERRORS\n"));
  EXPECT_THAT(text_of(files), HasSubstr("NUMBER VALUE\n0 0\n1 5\n2 5\n"));
  EXPECT_NEAR(fanuc_added_by_both(files, 1.0, -1), -6.0, 1e-9);
}

TEST(FanucTables, WhatIsNotConfirmedIsAskedFor) {
  const auto refusal = [](const Settings& settings) {
    TableFormatOptions options;
    options.type = CompensationPart::Positioning;
    options.step = 0.5;
    options.settings = settings;
    try {
      write_tables(fanuc(), with_reversal(), options);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(refusal({}), HasSubstr("sign is not confirmed publicly"));
  EXPECT_THAT(refusal({{"sign", "error"}}), HasSubstr("output is not confirmed publicly"));
  EXPECT_THAT(refusal({{"sign", "error"}, {"output", "even"}}),
              HasSubstr("reference_amount is not confirmed"));
  EXPECT_THAT(refusal({{"sign", "up"}}), HasSubstr("--set sign=compensation or --set sign=error"));
  const Settings known = {{"sign", "error"}, {"output", "even"}, {"reference_amount", "negative"}};
  const std::vector<std::array<std::string, 3>> wrong = {
      {"detection_unit_um", "0", "the detection unit in um"},
      {"largest_value", "200", "a whole number from 1 to 127"},
      {"first_number", "0.5", "a whole number from 0 to 1023"},
      {"first_number", "1020", "points up to number"},
      {"directions", "up", "--set directions=both"}};
  EXPECT_EQ(refusal(known), "");
  for (const auto& [name, value, message] : wrong) {
    Settings settings = known;
    settings[name] = value;
    EXPECT_THAT(refusal(settings), HasSubstr(message)) << name;
  }
}

}  // namespace
}  // namespace volcal
