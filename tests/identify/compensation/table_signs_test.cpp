// One point by hand per format: X goes 10 um too far at 1 m, Y leans by 30 urad, and what each file must say.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/identified_machines.h"
#include "tests/support/machines.h"
#include "tests/support/refusal.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

/// EXX = 10 um/m x; towards - it is 4 um less.
FitResult long_axis() {
  Machine machine = testing_support::machine_of("w X' b Y Z t");
  machine.tools = {{"short", Eigen::Vector3d::Zero(), 0.0}};
  return testing::result_with(
      machine, {.functions = {{"EXX", [](double q) { return 10e-6 * q; }}}, .reversals = {{"EXX", 4e-6}}},
      10);
}

/// EC0Y = 30 urad: at Y = 1 m the point lies 30 um towards -x.
FitResult leaning_axis() {
  return testing::result_with(testing_support::machine_of("w X' b Y Z t"), {.locations = {{"EC0Y", 30e-6}}},
                              10);
}

std::vector<TableFile> files_of(const std::string& format, const FitResult& result, CompensationType type,
                                std::map<std::string, std::string> settings = {}) {
  TableFormatOptions options;
  options.type = type;
  options.step = 0.5;
  options.settings = std::move(settings);
  return write_tables(*find_table_format(format), result, options);
}

std::string content_of(const std::vector<TableFile>& files, const std::string& name) {
  return file_named(files, name).content;
}

/// Added to the command of X, um.
double x_um(const std::string& format, const std::vector<TableFile>& files, const AxisPosition& at,
            int direction) {
  ApproachDirection approach{};
  approach.fill(static_cast<std::int8_t>(direction));
  return find_table_format(format)->read(files).correction(at, approach).linear.x() / 1e-6;
}

constexpr AxisPosition kFarX = {1.0, 0.5, 0.5};
constexpr AxisPosition kFarY = {0.5, 1.0, 0.5};

TEST(SignByHand, LinuxCncTrimsAreMinusTheErrorInMm) {
  const auto files = files_of("linuxcnc", long_axis(), CompensationPart::Positioning);
  EXPECT_EQ(content_of(files, "x.comp"),
            "0.000000 0.00000000 0.00400000\n500.000000 -0.00500000 -0.00100000\n"
            "1000.000000 -0.01000000 -0.00600000\n");
  EXPECT_THAT(content_of(files, "compensation.ini"),
              HasSubstr("[JOINT_0]\nCOMP_FILE = x.comp\nCOMP_FILE_TYPE = 1\n"));
  EXPECT_NEAR(x_um("linuxcnc", files, kFarX, 1), -10.0, 1e-6);
  EXPECT_NEAR(x_um("linuxcnc", files, kFarX, -1), -6.0, 1e-6);
}

TEST(SignByHand, LinuxCncInInches) {
  const auto files = files_of("linuxcnc", long_axis(), CompensationPart::Positioning, {{"units", "inch"}});
  EXPECT_THAT(content_of(files, "x.comp"), HasSubstr("39.370079 -0.00039370 -0.00023622\n"));
  EXPECT_NEAR(x_um("linuxcnc", files, kFarX, 1), -10.0, 1e-3);
}

TEST(SignByHand, LinuxCncType0HoldsActualPositions) {
  const std::vector<TableFile> files = {
      {"compensation.ini", "[TRAJ]\nLINEAR_UNITS = mm\n[JOINT_0]\nCOMP_FILE = x.comp\nCOMP_FILE_TYPE = 0\n"},
      {"x.comp", "0 0 0\n1000 1000.010 1000.006\n"}};
  EXPECT_NEAR(x_um("linuxcnc", files, kFarX, 1), -10.0, 1e-6);
  EXPECT_NEAR(x_um("linuxcnc", files, kFarX, -1), -6.0, 1e-6);
}

/// X and Z of a lathe are joints 0 and 1 (kins(9), trivkins coordinates=xz). Z goes 10 um too far at 1 m.
TEST(SignByHand, LinuxCncCountsTheJointsOfALathe) {
  const Machine lathe = testing_support::machine_of("w b Z X t");
  TableFormatOptions options;
  options.type = CompensationPart::Positioning;
  options.step = 0.5;
  FitResult result =
      testing::result_with(lathe, {.functions = {{"EZZ", [](double q) { return 10e-6 * q; }}}}, 2);
  result.machine.tools = {{"short", {0.0, 0.0, 0.0}, 0.0}};
  const auto files = find_table_format("linuxcnc")->write(result, options);
  const std::string ini = content_of(files, "compensation.ini");
  EXPECT_THAT(ini, ::testing::StartsWith("# coordinates = XZ\n[TRAJ]\n"));
  EXPECT_THAT(ini, HasSubstr("[JOINT_0]\nCOMP_FILE = x.comp\n"));
  EXPECT_THAT(ini, HasSubstr("[JOINT_1]\nCOMP_FILE = z.comp\n"));
  const auto correction =
      find_table_format("linuxcnc")->read(files).correction({0.0, 0.0, 1.0}, kTowardsPlus);
  EXPECT_NEAR(correction.linear.z(), -10e-6, 1e-11);
  EXPECT_EQ(correction.linear.y(), 0.0);
  EXPECT_THAT(
      content_of(files_of("linuxcnc", long_axis(), CompensationPart::Positioning), "compensation.ini"),
      ::testing::StartsWith("[TRAJ]\n"));
}

TEST(SignByHand, IsgCsvNeedsThreeLinearAxes) {
  FitResult result = testing::result_with(testing_support::machine_of("w b Z X t"),
                                          {.functions = {{"EZZ", [](double q) { return 10e-6 * q; }}}}, 2);
  result.machine.tools = {{"short", {0.0, 0.0, 0.0}, 0.0}};
  for (const CompensationType type :
       {CompensationType(CompensationPart::Positioning), CompensationType::volumetric()}) {
    TableFormatOptions options;
    options.type = type;
    options.step = 0.5;
    EXPECT_THAT(testing::refusal([&] { find_table_format("isg-csv")->write(result, options); }),
                HasSubstr("needs the three linear axes X, Y and Z (write --format isg-ssfk"));
    if (type.is_separable()) {
      EXPECT_NO_THROW(find_table_format("isg-ssfk")->write(result, options));
    }
  }
}

TEST(TableOptions, ARotaryTableAloneGetsNoTables) {
  FitResult result = testing::result_with(testing_support::machine_of("w C' b t"),
                                          {.functions = {{"ECC", [](double q) { return 1e-6 * q; }}}}, 2);
  result.machine.tools = {{"short", {0.0, 0.0, 0.0}, 0.0}};
  for (const char* name : {"csv", "sinumerik"}) {
    const TableFormat& format = *find_table_format(name);
    TableFormatOptions options;
    options.type = format.supported;
    EXPECT_THAT(
        testing::refusal([&] { write_tables(format, result, options); }),
        HasSubstr("beside those of linear ones (take the errors of its rotary axes from error_tables.csv"))
        << name;
  }
}

TEST(SignByHand, LinuxCncGridHoldsCorrectionsAndHalfTheReversal) {
  const auto files = files_of("linuxcnc-grid", long_axis(), CompensationType::volumetric());
  const std::string nothing = " 0.000000000 0.000000000 0.000000000";
  EXPECT_THAT(content_of(files, "volcal.grid"),
              HasSubstr("volcal-grid-1 mm 3 3 3\n0.000000 0.000000 0.000000 0.002000000 0.000000000"));
  EXPECT_THAT(content_of(files, "volcal.grid"),
              HasSubstr("\n1000.000000 0.000000 0.000000 -0.008000000 0.000000000 0.000000000 "
                        "-0.002000000 0.000000000 0.000000000" +
                        nothing + nothing + "\n"))
      << "mean of both directions, then half of the 4 um that it goes farther towards +";
  EXPECT_NEAR(x_um("linuxcnc-grid", files, kFarX, 1), -10.0, 1e-6);
  EXPECT_NEAR(x_um("linuxcnc-grid", files, kFarX, -1), -6.0, 1e-6);
}

TEST(SignByHand, NeutralTablesHoldCorrections) {
  const auto files = files_of("neutral-csv", long_axis(), CompensationPart::Positioning);
  EXPECT_THAT(content_of(files, "axis_corrections.csv"), HasSubstr("X,X,1000,-10,-6\n"));
  EXPECT_NEAR(x_um("neutral-csv", files, kFarX, -1), -6.0, 1e-6);
  const auto grid = files_of("neutral-csv", long_axis(), CompensationType::volumetric());
  EXPECT_THAT(content_of(grid, "correction_grid.csv"), HasSubstr("1000,0,0,-8,0,0,-4,0,0,0,0,0,0,0,0\n"))
      << "mean of both directions, then the reversal of X: towards + minus towards -";
  EXPECT_NEAR(x_um("neutral-csv", grid, kFarX, 1), -10.0, 1e-6);
}

TEST(SignByHand, NativeTablesHoldErrorsAndCompensations) {
  const auto files = files_of("csv", long_axis(), CompensationType::volumetric());
  EXPECT_THAT(content_of(files, "error_tables.csv"), HasSubstr("EXX,X,1000,mm,1,12,um,0,0,0\n"));
  EXPECT_THAT(content_of(files, "error_tables.csv"), HasSubstr("EXX,X,1000,mm,-1,8,um,0,0,0\n"));
  EXPECT_THAT(content_of(files, "compensation_tables.csv"), HasSubstr("EXX,X,1000,mm,1,-12,um,0,0,0\n"));
  EXPECT_NEAR(x_um("csv", files, kFarX, 1), -10.0, 1e-6);
  EXPECT_NEAR(x_um("csv", files, kFarX, -1), -6.0, 1e-6);
}

TEST(SignByHand, IsgHoldsErrorsInMm) {
  const auto files = files_of("isg-csv", long_axis(), CompensationPart::Positioning, {{"reversal", "lists"}});
  EXPECT_THAT(content_of(files, "volcomp.csv"), HasSubstr("X EXX\n0.000000 0.000000000\n"))
      << "mean of both directions, zero at home";
  EXPECT_THAT(content_of(files, "volcomp.csv"), HasSubstr("1000.000000 0.010000000\n"));
  EXPECT_THAT(content_of(files, "achskw1.lis"), HasSubstr(".pos 0\nkw.ssfk.table[0].neg -40\n"))
      << "the reversal, zero at home towards +";
  EXPECT_NEAR(x_um("isg-csv", files, kFarX, 1), -10.0, 1e-6);
  EXPECT_NEAR(x_um("isg-csv", files, kFarX, -1), -6.0, 1e-6);
  const std::vector<TableFile> tables_alone(files.begin(), files.begin() + 2);
  EXPECT_NEAR(x_um("isg-csv", tables_alone, kFarX, 1), -10.0, 1e-6);
  EXPECT_NEAR(x_um("isg-csv", tables_alone, kFarX, -1), -10.0, 1e-6);
}

TEST(SignByHand, LeadscrewListsHoldErrorsInTenthsOfMicrometres) {
  const auto files = files_of("isg-ssfk", long_axis(), CompensationPart::Positioning);
  const std::string& x = content_of(files, "achskw1.lis");
  EXPECT_THAT(x, HasSubstr("kw.ssfk.table[0].setpoint 0\n"));
  EXPECT_THAT(x, HasSubstr("setpoint 10000000\nkw.ssfk.table[0].pos 0\n"));
  EXPECT_THAT(x, HasSubstr(".pos 100\nkw.ssfk.table[0].neg -40\n"));
  EXPECT_THAT(x, HasSubstr(".neg 60\nEnd\n"));
  EXPECT_NEAR(x_um("isg-ssfk", files, kFarX, 1), -10.0, 1e-6);
  EXPECT_NEAR(x_um("isg-ssfk", files, kFarX, -1), -6.0, 1e-6);
}

TEST(SignByHand, EtalonExchangeHoldsErrorsInMm) {
  const auto files = files_of("etalon-exchange", long_axis(), CompensationPart::Positioning);
  EXPECT_THAT(content_of(files, "volcomp.txt"), HasSubstr("[EXX]\nGridpoints = {\n0.000000 0.000000000\n"));
  EXPECT_THAT(content_of(files, "volcomp.txt"), HasSubstr("1000.000000 0.010000000\n}"));
}

/// What Y does to X stands under Y and X, not the other way round.
TEST(SignByHand, CausingAndCorrectedAxisStandInTheirPlaces) {
  const auto neutral = files_of("neutral-csv", leaning_axis(), CompensationPart::Squareness);
  EXPECT_THAT(content_of(neutral, "axis_corrections.csv"), HasSubstr("Y,X,1000,30,30\n"));
  const auto etalon = files_of("etalon-exchange", leaning_axis(), CompensationPart::Squareness);
  EXPECT_THAT(content_of(etalon, "volcomp.txt"),
              HasSubstr("[EXY]\nGridpoints = {\n0.000000 0.000000000\n500.000000 -0.015000000\n"
                        "1000.000000 -0.030000000\n}"));
  const auto isg = files_of("isg-csv", leaning_axis(), CompensationPart::Squareness);
  EXPECT_THAT(content_of(isg, "volcomp.csv"), HasSubstr("Y EXY EZY\n"));
  EXPECT_THAT(content_of(isg, "volcomp.csv"), HasSubstr("1000.000000 -0.030000000 0.000000000\n"));
  const auto grid = files_of("isg-csv", long_axis(), CompensationType::volumetric());
  EXPECT_THAT(content_of(grid, "volcomp.csv"), HasSubstr("X Y Z EXX EYY EZZ\n"));
  EXPECT_THAT(content_of(grid, "volcomp.csv"),
              HasSubstr("1000.000000 0.000000 0.000000 0.010000000 0.000000000 0.000000000\n"));
}

TEST(SignByHand, SinumerikEncoderTablesHoldErrorsInMm) {
  const auto files = files_of("sinumerik", long_axis(), CompensationPart::Positioning);
  EXPECT_THAT(content_of(files, "AX_EEC.INI"), HasSubstr("$AA_ENC_COMP[0,2,X1]=0.010000\n"));
  EXPECT_THAT(content_of(files, "AX_EEC.INI"), HasSubstr("$AA_ENC_COMP_STEP[0,X1]=500.000000\n"));
  EXPECT_NEAR(x_um("sinumerik", files, kFarX, 1), -10.0, 1e-6);
}

TEST(SignByHand, SinumerikCecIsAskedFor) {
  EXPECT_THROW(files_of("sinumerik-cec", leaning_axis(), CompensationPart::Squareness), InputError);
  const auto errors =
      files_of("sinumerik-cec", leaning_axis(), CompensationPart::Squareness, {{"cec_sign", "error"}});
  const auto corrections =
      files_of("sinumerik-cec", leaning_axis(), CompensationPart::Squareness, {{"cec_sign", "compensation"}});
  EXPECT_THAT(content_of(errors, "NC_CEC.INI"),
              HasSubstr("$AN_CEC[2,2]=-0.030000\n$AN_CEC_INPUT_AXIS[2]=(Y1)\n"
                        "$AN_CEC_OUTPUT_AXIS[2]=(X1)\n"));
  EXPECT_THAT(content_of(corrections, "NC_CEC.INI"), HasSubstr("$AN_CEC[2,2]=0.030000\n"));
  EXPECT_NEAR(x_um("sinumerik-cec", errors, kFarY, 1), 30.0, 1e-3);
  EXPECT_NEAR(x_um("sinumerik-cec", corrections, kFarY, 1), 30.0, 1e-3);
}

TEST(SignByHand, HeidenhainIsAskedFor) {
  EXPECT_THROW(files_of("heidenhain", leaning_axis(), CompensationPart::Squareness), InputError);
  const auto errors =
      files_of("heidenhain", leaning_axis(), CompensationPart::Squareness, {{"sign", "error"}});
  const auto corrections =
      files_of("heidenhain", leaning_axis(), CompensationPart::Squareness, {{"sign", "compensation"}});
  EXPECT_EQ(content_of(errors, "Y.COM.txt"),
            "; VOLCAL VALUES ARE ERRORS\nAXISPOS X Z\n0.0000 0.0000 0.0000\n500.0000 -0.0150 0.0000\n"
            "1000.0000 -0.0300 0.0000\n");
  EXPECT_EQ(content_of(errors, "CONFIG.CMA.txt"), "ACTIVE X Y Z\n* X.COM Y.COM Z.COM\n");
  EXPECT_THAT(content_of(corrections, "Y.COM.txt"), HasSubstr("1000.0000 0.0300 0.0000\n"));
  EXPECT_NEAR(x_um("heidenhain", errors, kFarY, 1), 30.0, 1e-3);
  EXPECT_NEAR(x_um("heidenhain", corrections, kFarY, 1), 30.0, 1e-3);
}

TEST(SignByHand, FanucIsAskedFor) {
  EXPECT_THROW(files_of("fanuc", long_axis(), CompensationPart::Positioning), InputError);
  std::map<std::string, std::string> settings = {
      {"sign", "compensation"}, {"output", "even"}, {"reference_amount", "negative"}};
  const auto corrections = files_of("fanuc", long_axis(), CompensationPart::Positioning, settings);
  settings["sign"] = "error";
  const auto errors = files_of("fanuc", long_axis(), CompensationPart::Positioning, settings);
  EXPECT_THAT(content_of(corrections, "pitch_error.txt"), HasSubstr("3627 X 4\n"));
  EXPECT_THAT(content_of(corrections, "pitch_error.txt"), HasSubstr("0 0\n1 -5\n2 -5\n3 0\n4 -5\n5 -5\n"));
  EXPECT_THAT(content_of(errors, "pitch_error.txt"), HasSubstr("3627 X -4\n"));
  EXPECT_THAT(content_of(errors, "pitch_error.txt"), HasSubstr("0 0\n1 5\n2 5\n3 0\n4 5\n5 5\n"));
  for (const auto& files : {corrections, errors}) {
    EXPECT_NEAR(x_um("fanuc", files, kFarX, 1), -10.0, 1e-6);
    EXPECT_NEAR(x_um("fanuc", files, kFarX, -1), -6.0, 1e-6);
  }
}

TEST(SignByHand, SkewFactorsAreSlopesOfTheError) {
  const auto klipper = files_of("klipper", leaning_axis(), CompensationPart::Squareness);
  EXPECT_THAT(content_of(klipper, "skew_correction.cfg"), HasSubstr("xy_skew = -3e-05\n"));
  EXPECT_NEAR(x_um("klipper", klipper, kFarY, 1), 30.0, 1e-3);
  const auto marlin = files_of("marlin", leaning_axis(), CompensationPart::Squareness);
  EXPECT_EQ(content_of(marlin, "skew.gcode"), "G21\nM852 I-0.000030000 J0.000000000 K0.000000000\nM500\n");
  EXPECT_NEAR(x_um("marlin", marlin, kFarY, 1), 30.0, 1e-3);
}

}  // namespace
}  // namespace volcal
