// Compensation value tables of HEIDENHAIN controls against the examples of their manuals and by hand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
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

const TableFormat& heidenhain() { return *find_table_format("heidenhain"); }

/// Added to the commands, um, as the format's own reader and the simulated control say.
Eigen::Vector3d heidenhain_added_by_both(const std::vector<TableFile>& files, const AxisPosition& at) {
  const Eigen::Vector3d own = heidenhain().read(files).correction(at, kTowardsPlus).linear;
  sim::MachineState state;
  state.position = at;
  state.direction = kTowardsPlus;
  const auto control = sim::command_correction({control_tables(heidenhain(), files), 0.0, {}});
  EXPECT_LT((own - control(state).linear).norm(), 1e-12);
  return own / 1e-6;
}

AxisPosition z_mm(double z) { return {0.0, 0.0, z * 1e-3}; }
AxisPosition y_mm(double y) { return {0.0, y * 1e-3, 0.0}; }

/// TNC 306 Technical Manual, 03.97, page 4-21: Y = F(Z), lines 3 and 4 without an entry, linear between.
TEST(HeidenhainTables, InterpolateLikeTheExampleOfTnc306) {
  const std::vector<TableFile> files = {{"CONFIG.CMA.txt", "ACTIVE Z\n* Z.COM\n"},
                                        {"Z.COM.txt",
                                         "; VOLCAL VALUES ARE COMPENSATIONS\nAXISPOS Y\n"
                                         "-990 0\n-973.616 -0.06\n-957.232 -0.09\n-908.08 -0.12\n"
                                         "-891.696 -0.12\n-875.312 -0.1\n-858.928 -0.09\n"}};
  EXPECT_NEAR(heidenhain_added_by_both(files, z_mm(-973.616)).y(), -60.0, 1e-6);
  EXPECT_NEAR(heidenhain_added_by_both(files, z_mm(-940.848)).y(), -100.0, 1e-6)
      << "line 3: a third of the way";
  EXPECT_NEAR(heidenhain_added_by_both(files, z_mm(-924.464)).y(), -110.0, 1e-6) << "line 4: two thirds";
  EXPECT_NEAR(heidenhain_added_by_both(files, z_mm(-858.928)).y(), -90.0, 1e-6);
  EXPECT_EQ(heidenhain_added_by_both(files, z_mm(-940.848)).z(), 0.0) << "Y is moved, not Z";
}

/// The same page: the largest difference is 16.384 mm / 64 = 0.256 mm.
TEST(HeidenhainTables, TakeA64thOfTheSpacingAtMost) {
  const auto files = [](const char* value) {
    return std::vector<TableFile>{{"CONFIG.CMA.txt", "ACTIVE Z\n* Z.COM\n"},
                                  {"Z.COM.txt", "; VOLCAL VALUES ARE ERRORS\nAXISPOS Y\n-990 0\n-973.616 " +
                                                    std::string(value) + "\n"}};
  };
  EXPECT_NO_THROW(heidenhain().read(files("0.2559")));
  try {
    heidenhain().read(files("0.2561"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().line, 4);
    EXPECT_THAT(error.what(), HasSubstr("Y = F(Z) changes by more than 0.2560 mm"));
  }
}

/// TNC 407/415/425 Technical Manual, 01.98, page 4-28: datum -90, spacing 2^16 = 6.5536 mm; every second
/// point is at -76.8928, -63.7856, -50.6784, -37.5712, -24.464, -11.3568, 1.7504.
TEST(HeidenhainTables, PointsOfADatumStandWhereTheExampleOfTnc407HasThem) {
  std::string rows;
  for (int i = 0; i <= 14; ++i)
    rows += std::to_string(i) + " 0 0.0" + (i < 10 ? "0" : "") + std::to_string(i) + "\n";
  const std::vector<TableFile> files = {
      {"CONFIG.CMA.txt", "ACTIVE Y\n* Y.COM\n"},
      {"Y.COM.txt", "; VOLCAL VALUES ARE ERRORS\nDATUM -90\nSPACING 16\nNR Y Z\n" + rows}};
  const std::array<double, 8> marked = {-90.0,    -76.8928, -63.7856, -50.6784,
                                        -37.5712, -24.464,  -11.3568, 1.7504};
  for (std::size_t i = 0; i < marked.size(); ++i)
    EXPECT_NEAR(heidenhain_added_by_both(files, y_mm(marked[i])).z(), -2.0 * static_cast<double>(i), 1e-6);
}

/// MANUALplus 620 Technical Manual, 01/2012, page 718: the axis of the column of the .COM is a function of
/// the axis of the column of the .CMA; sag Z = F(Y) beside Y = F(Y), one line active.
TEST(HeidenhainTables, AssignLikeTheExampleOfManualPlus) {
  const std::vector<TableFile> files = {
      {"CONFIG.CMA.txt", "ACTIVE Y Z\n- OLD.COM OLD.COM\n* Y.COM Z.COM\n"},
      {"Y.COM.txt", "; VOLCAL VALUES ARE COMPENSATIONS\nAXISPOS Y Z\n-90 0 0\n410 0.01 0.02\n"},
      {"Z.COM.txt", "; VOLCAL VALUES ARE COMPENSATIONS\nAXISPOS Z\n-200 0\n600 0.04\n"}};
  const Eigen::Vector3d added = heidenhain_added_by_both(files, {0.0, 0.16, 0.0});
  EXPECT_NEAR(added.y(), 5.0, 1e-6);
  EXPECT_NEAR(added.z(), 10.0 + 10.0, 1e-6) << "sag and pitch at once";
}

FitResult sagging() {
  Machine machine = testing_support::machine_of("w X' b Y Z t");
  machine.axes[1].travel_min = -0.3;
  return testing::result_with(
      machine, {.functions = {{"EYY", [](double q) { return 12e-6 * q; }}}, .locations = {{"EA0Z", 20e-6}}},
      10);
}

std::vector<TableFile> write_heidenhain(const FitResult& result, std::map<std::string, std::string> settings,
                                        double step = 0.3, CompensationType type = heidenhain().supported) {
  TableFormatOptions options;
  options.type = type;
  options.step = step;
  options.settings = std::move(settings);
  return write_tables(heidenhain(), result, options);
}

/// 0.02 mm of step / 0.1 um = 200000, 2^17 = 131072: 13.1072 mm. The curve begins with 0 at the datum.
TEST(HeidenhainTables, SpacingIsThePowerOfTwoBelowTheStep) {
  const auto files = write_heidenhain(sagging(), {{"sign", "error"}, {"rows", "spacing"}}, 20e-3,
                                      CompensationPart::Positioning);
  // -300 mm is 22.9 spacings from home: 23 of them are -301.4656 mm
  EXPECT_THAT(file_named(files, "Y.COM.txt").content,
              HasSubstr("DATUM -301.4656\nSPACING 17\nNR Y\n0 0.0000\n1 0.0002\n2 0.0003\n"));
  EXPECT_NEAR(
      heidenhain_added_by_both(files, y_mm(1000.0)).y() - heidenhain_added_by_both(files, y_mm(0.0)).y(),
      -12.0, 0.1);
}

TEST(HeidenhainTables, HoldTheSignThatIsAskedFor) {
  EXPECT_THROW(write_heidenhain(sagging(), {}), InputError);
  EXPECT_THROW(write_heidenhain(sagging(), {{"sign", "up"}}), InputError);
  const auto errors = write_heidenhain(sagging(), {{"sign", "error"}});
  const auto corrections = write_heidenhain(sagging(), {{"sign", "compensation"}});
  EXPECT_THAT(file_named(errors, "Y.COM.txt").content,
              HasSubstr("AXISPOS X Y Z\n-300.0000 0.0000 -0.0036 0.0000\n"));
  EXPECT_THAT(file_named(corrections, "Y.COM.txt").content,
              HasSubstr("AXISPOS X Y Z\n-300.0000 0.0000 0.0036 0.0000\n"));
  EXPECT_THAT(file_named(errors, "CONFIG.CMA.txt").content, HasSubstr("ACTIVE X Y Z\n* X.COM Y.COM Z.COM\n"));
  EXPECT_NEAR(heidenhain_added_by_both(errors, y_mm(900.0)).y(), -10.8, 1e-6);
  EXPECT_NEAR(heidenhain_added_by_both(corrections, y_mm(900.0)).y(), -10.8, 1e-6);
}

/// 9 dependencies; 640 points / 9 = 71.
TEST(HeidenhainTables, PointsOfAllDependenciesAreCounted) {
  EXPECT_NO_THROW(write_heidenhain(sagging(), {{"sign", "error"}, {"rows", "spacing"}}, 30e-3));
  try {
    write_heidenhain(sagging(), {{"sign", "error"}, {"rows", "spacing"}}, 10e-3);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the control has 10 with 640"));
    EXPECT_THAT(error.remedy(), HasSubstr("--step"));
  }
  EXPECT_NO_THROW(write_heidenhain(sagging(), {{"sign", "error"}}, 10e-3)) << "256 points of each table";
  EXPECT_THROW(write_heidenhain(sagging(), {{"sign", "error"}}, 3e-3), InputError);
}

}  // namespace
}  // namespace volcal
