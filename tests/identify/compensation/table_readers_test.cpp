// Malformed tables of every format: the message names the file, the line and the remedy. And what is written
// is read back as it was.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/error_oracles.h"
#include "tests/support/table_samples.h"
#include "volcal/identify/compensation/csv_tables.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using testing::sample_tables;
using testing::small_result;

struct Malformed {
  const char* format;
  const char* file;
  const char* from;  ///< replaced once, from its last place
  const char* to;
  int line;             ///< of the message; 0 = the whole file
  const char* problem;  ///< part of the message
};

class MalformedTables : public ::testing::TestWithParam<Malformed> {};

TEST_P(MalformedTables, AreRefusedWithFileLineAndRemedy) {
  const Malformed& broken = GetParam();
  const std::string_view name = broken.file;
  std::optional<CompensationType> type;
  if (name == "axis_corrections.csv") type = CompensationPart::Positioning;
  if (name == "NC_CEC.INI")
    type = CompensationType(CompensationPart::Positioning) | CompensationPart::Straightness |
           CompensationPart::Squareness;
  std::vector<TableFile> files = sample_tables(*find_table_format(broken.format), type);
  std::string* content = nullptr;
  for (TableFile& file : files) {
    if (file.name == broken.file) content = &file.content;
  }
  ASSERT_NE(content, nullptr);
  const auto place = content->rfind(broken.from);
  ASSERT_NE(place, std::string::npos) << *content;
  content->replace(place, std::string_view(broken.from).size(), broken.to);
  try {
    find_table_format(broken.format)->read(files);
    FAIL() << "was read:\n" << *content;
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().file, broken.file) << error.what();
    EXPECT_EQ(error.place().line, broken.line) << error.what();
    EXPECT_THAT(error.what(), HasSubstr(broken.problem));
    EXPECT_FALSE(error.remedy().empty());
  }
}

INSTANTIATE_TEST_SUITE_P(
    Csv, MalformedTables,
    ::testing::Values(
        Malformed{"csv", "compensation_tables.csv", "EXX,X,500", "EXQ,X,500", 6, "symbol is \"EXQ\""},
        Malformed{"csv", "compensation_tables.csv", "EXX,X,500,mm", "EXX,Y,500,mm", 6, "axis is \"Y\""},
        Malformed{"csv", "compensation_tables.csv", "EXX,X,500,mm", "EXX,X,500,in", 6, "position_unit"},
        Malformed{"csv", "compensation_tables.csv", "EXX,X,500,mm,-1,", "EXX,X,500,mm,2,", 6, "direction"},
        Malformed{"csv", "compensation_tables.csv", "EXX,X,500", "EXX,X,5oo", 6, "not a number of a table"},
        Malformed{"csv", "compensation_tables.csv", "EXX,X,500", "EXX,X,+-500", 6, "not a number of a table"},
        Malformed{"csv", "compensation_tables.csv", "compensation,unit", "value,unit", 1, "the header is"},
        Malformed{"csv", "compensation_tables.csv", "EC0Y,,", "EC0Y,Y,", 18, "neither axis nor position"},
        Malformed{"csv", "compensation_tables.csv", "EXX,X,500,mm,-1,", "EXX,X,2500,mm,-1,", 7,
                  "does not lie beyond"},
        Malformed{"csv", "metadata.csv", "format,volcal-tables-1", "format,volcal-tables-9", 2,
                  "volcal-tables-9"},
        Malformed{"csv", "metadata.csv", "\ntool,short", "\ntool,long", 7, "tool is \"long\""},
        Malformed{"csv", "metadata.csv", "w X' b Y Z t", "w X' b Q Z t", 13, "structure"},
        Malformed{"csv", "metadata.csv", "datum.primary,X", "datum.primary,C", 14, "datum.primary"},
        Malformed{"csv", "metadata.csv", "travel_max_mm,1000", "travel_max_mm,-1", 29, "travel_max_mm"},
        Malformed{"csv", "metadata.csv", "axis.Y.home_mm", "axis.Y.hom_mm", 0, "axis.Y.home_mm is missing"}));

INSTANTIATE_TEST_SUITE_P(Neutral, MalformedTables,
                         ::testing::Values(Malformed{"neutral-csv", "axis_corrections.csv", "Z,Z,500",
                                                     "A,Z,500", 9, "input_axis is \"A\""},
                                           Malformed{"neutral-csv", "axis_corrections.csv", "Z,Z,500",
                                                     "Z,Z,1000", 10, "does not lie beyond"},
                                           Malformed{"neutral-csv", "axis_corrections.csv", "Z,Z,500,",
                                                     "Z,Z,500", 9, "the row has 4 cells"},
                                           Malformed{"neutral-csv", "axis_corrections.csv", "towards_plus_um",
                                                     "towards_plus_mm", 1, "the header is"},
                                           Malformed{"neutral-csv", "correction_grid.csv", "1000,1000,500,",
                                                     "1000,1000,501,", 4, "not a complete grid"},
                                           Malformed{"neutral-csv", "correction_grid.csv", "1000,1000,500,",
                                                     "1000,1000,nan,", 27, "not a number of a table"}));

INSTANTIATE_TEST_SUITE_P(
    LinuxCnc, MalformedTables,
    ::testing::Values(
        Malformed{"linuxcnc", "x.comp", "19.685039 ", "# middle\n19.685039 ", 2, "stops reading here"},
        Malformed{"linuxcnc", "x.comp", "\n19.685039 ", "\n\n19.685039 ", 2, "stops reading here"},
        Malformed{"linuxcnc", "x.comp", "19.685039", "59.685039", 3, "does not lie beyond"},
        Malformed{"linuxcnc", "x.comp", "19.685039", "19,685039", 2, "not a number of a table"},
        Malformed{"linuxcnc", "compensation.ini", "LINEAR_UNITS = inch", "LINEAR_UNITS = cm", 2,
                  "neither mm nor inch"},
        Malformed{"linuxcnc", "compensation.ini", "COMP_FILE_TYPE = 1", "COMP_FILE_TYPE = 2", 14,
                  "neither 0 nor 1"},
        Malformed{"linuxcnc", "compensation.ini", "[JOINT_2]", "[JOINT_3]", 12, "JOINT_3"},
        Malformed{"linuxcnc", "compensation.ini", "COMP_FILE = z.comp", "COMP_FILE z.comp", 13,
                  "KEY = VALUE"}));

INSTANTIATE_TEST_SUITE_P(
    LinuxCncGrid, MalformedTables,
    ::testing::Values(
        Malformed{"linuxcnc-grid", "volcal.grid", "volcal-grid-1", "volcal-grid-9", 3, "header is missing"},
        Malformed{"linuxcnc-grid", "volcal.grid", "inch", "cm", 3, "neither mm nor inch"},
        Malformed{"linuxcnc-grid", "volcal.grid", " 3 3 3\n", " 3 3 0\n", 3, "out of range"},
        Malformed{"linuxcnc-grid", "volcal.grid", " 3 3 3\n", " 3 3 4\n", 30, "promises 4 positions of Z"},
        Malformed{"linuxcnc-grid", "volcal.grid", "39.370079 39.370079 19.685039 ", "39.370079 39.370079 ",
                  29, "the row has 14 numbers"},
        Malformed{"linuxcnc-grid", "volcal.grid", "39.370079 39.370079 19.685039 ",
                  "39.370079 39.370079 19.685038 ", 5, "not a complete grid"}));

INSTANTIATE_TEST_SUITE_P(
    Skew, MalformedTables,
    ::testing::Values(
        Malformed{"klipper", "skew_correction.cfg", "xz_skew", "zx_skew", 5, "zx_skew is not one"},
        Malformed{"klipper", "skew_correction.cfg", "xz_skew", "xy_skew", 5, "xy_skew is given twice"},
        Malformed{"klipper", "skew_correction.cfg", "yz_skew = ", "yz_skew = zero ", 6,
                  "not a number of a table"},
        Malformed{"marlin", "skew.gcode", "G21\n", "", 1, "before G21"},
        Malformed{"marlin", "skew.gcode", "G21", "G20", 1, "neither G21, M852 nor M500"},
        Malformed{"marlin", "skew.gcode", "J", "X", 2, "no such word"},
        Malformed{"marlin", "skew.gcode", "K0.", "K7.", 2, "beyond +-1"}));

INSTANTIATE_TEST_SUITE_P(
    Isg, MalformedTables,
    ::testing::Values(
        Malformed{"isg-csv", "volcomp.csv", "X Y Z EXX", "X Y Z EAX", 1, "EAX is not read here"},
        Malformed{"isg-csv", "volcomp.csv", "X Y Z EXX", "X Y Z EXX 1", 1, "1 is not read here"},
        Malformed{"isg-csv", "volcomp.csv", "1000.000000 1000.000000 500.000000", "1000.000000 1000.000000",
                  27, "5 numbers"},
        Malformed{"isg-csv", "volcomp.lis", "GRID", "SCATTER", 0, "interpolation is \"SCATTER\""},
        Malformed{"isg-csv", "volcomp.lis", "workpiece_axes 0", "workpiece_axes 1", 0,
                  "workpiece_axes is \"1\""},
        Malformed{"isg-csv", "volcomp.lis", "interpolation", "negate 1\ninterpolation", 5,
                  "negate is not read"},
        Malformed{"etalon-exchange", "volcomp.txt", "[EXX]", "[EAX]", 1, "must begin with a displacement"},
        Malformed{"etalon-exchange", "volcomp.txt", "[EYX]", "[EXX]", 7, "EXX is given twice"},
        Malformed{"etalon-exchange", "volcomp.txt", "[EXX]\nGridpoints", "[EXX]\nPoints", 2,
                  "Gridpoints = {"},
        Malformed{"etalon-exchange", "volcomp.txt", "}\n", "", 53, "does not end"}));

INSTANTIATE_TEST_SUITE_P(
    Leadscrew, MalformedTables,
    ::testing::Values(
        Malformed{"isg-ssfk", "achskw2.lis", "End\n", "", 18, "does not end in End"},
        Malformed{"isg-ssfk", "achskw2.lis", "unit 1", "unit 0", 19, "unit is not 1"},
        Malformed{"isg-ssfk", "achskw2.lis", "unit 1 /* 0.1 um */", "unit 1 /* 0.1 um", 7, "does not end on"},
        Malformed{"isg-ssfk", "achskw2.lis", "log_achs_name Y", "log_achs_name A", 19, "\"A\""},
        Malformed{"isg-ssfk", "achskw3.lis", "log_achs_name Z", "log_achs_name Y", 0, "has two lists"},
        Malformed{"isg-ssfk", "achskw2.lis", "kw_nr_max 3", "kw_nr_max 4", 19,
                  "table[3].setpoint is missing"},
        Malformed{"isg-ssfk", "achskw2.lis", "table[2].neg", "table[1].neg", 18, "given twice"},
        Malformed{"isg-ssfk", "achskw2.lis", "table[2].neg", "table[9999].neg", 18, "not among"},
        Malformed{"isg-ssfk", "achskw2.lis", "table[1].setpoint 5", "table[1].setpoint 50", 19,
                  "does not lie beyond"},
        Malformed{"isg-ssfk", "achskw2.lis", "modulo 0", "modulo 1", 19, "modulo is not 0"}));

INSTANTIATE_TEST_SUITE_P(
    Sinumerik, MalformedTables,
    ::testing::Values(
        Malformed{"sinumerik", "AX_EEC.INI", "%_N_AX_EEC_INI", "%_N_AX_CEC_INI", 1, "does not begin with"},
        Malformed{"sinumerik", "AX_EEC.INI", "M17\n", "", 26, "does not end in M17"},
        Malformed{"sinumerik", "AX_EEC.INI", "[0,1,Z1]=", "[0,1,Z1] ", 21, "not an assignment"},
        Malformed{"sinumerik", "AX_EEC.INI", "[0,1,Z1]", "[0,0,Z1]", 21, "a second time"},
        Malformed{"sinumerik", "AX_EEC.INI", "[0,1,Z1]", "[0,1,W1]", 21, "machine axis is \"W1\""},
        Malformed{"sinumerik", "AX_EEC.INI", "_MAX[0,Z1]=1000", "_MAX[0,Z1]=2000", 26,
                  "do not reach from MIN"},
        Malformed{"sinumerik", "AX_EEC.INI", "$AA_ENC_COMP_STEP[0,Z1]=500.000000\n", "", 25,
                  "STEP, MIN or MAX is missing"},
        Malformed{"sinumerik", "AX_EEC.INI", "_STEP[0,Z1]", "_STEP[0]", 23, "machine axis is missing"},
        Malformed{"sinumerik", "AX_EEC.INI", "_IS_MODULO[0,Z1]=0", "_IS_MODULO[0,Z1]=1", 26,
                  "is not read here"},
        Malformed{"sinumerik-cec", "NC_CEC.INI", ";VOLCAL VALUES ARE ERRORS\n", "", 124,
                  "sign of the values"},
        Malformed{"sinumerik-cec", "NC_CEC.INI", "_DIRECTION[0]=1", "_DIRECTION[0]=3", 12,
                  "DIRECTION is neither"},
        Malformed{"sinumerik-cec", "NC_CEC.INI", "_MULT_BY_TABLE[0]=0", "_MULT_BY_TABLE[0]=99", 13,
                  "no table number 99"},
        Malformed{"sinumerik-cec", "NC_CEC.INI", "_OUTPUT_AXIS[0]=(X1)", "_OUTPUT_AXIS[0]=(C1)", 8, "C1"}));

INSTANTIATE_TEST_SUITE_P(
    Heidenhain, MalformedTables,
    ::testing::Values(
        Malformed{"heidenhain", "X.COM.txt", "; VOLCAL VALUES ARE ERRORS\n", "", 1, "what the values are"},
        Malformed{"heidenhain", "X.COM.txt", "AXISPOS X Y Z", "AXISPOS X Y Y", 2, "column is named \"Y\""},
        Malformed{"heidenhain", "X.COM.txt", "AXISPOS X", "POS X", 2, "neither AXISPOS nor"},
        Malformed{"heidenhain", "X.COM.txt", "AXISPOS X", "DATUM 0\nAXISPOS X", 3, "do not stand together"},
        Malformed{"heidenhain", "X.COM.txt", "AXISPOS X", "DATUM 0\nSPACING 24\nNR X", 3, "out of range"},
        Malformed{"heidenhain", "X.COM.txt", "AXISPOS X", "DATUM 0\nSPACING 23\nNR X", 6, "not number 1"},
        Malformed{"heidenhain", "X.COM.txt", "\n500.0000 ", "\n1500.0000 ", 5, "does not lie beyond"},
        Malformed{"heidenhain", "X.COM.txt", "\n500.0000 ", "\n500,0000 ", 4, "not a number of a table"},
        Malformed{"heidenhain", "X.COM.txt", "\n1000.0000 ", "\n", 5, "the row has 3 cells"},
        Malformed{"heidenhain", "CONFIG.CMA.txt", "\n* ", "\n- ", 2, "no line is active"},
        Malformed{"heidenhain", "CONFIG.CMA.txt", " Z.COM\n", "\n", 2, "another number of cells"},
        Malformed{"heidenhain", "CONFIG.CMA.txt", "Z.COM\n", "Z.COM\n* X.COM Y.COM Z.COM\n", 3, "two lines"},
        Malformed{"heidenhain", "CONFIG.CMA.txt", "ACTIVE X", "ACTIVE U", 1, "column is named \"U\""},
        Malformed{"heidenhain", "CONFIG.CMA.txt", "ACTIVE", "NR", 1, "not ACTIVE"}));

INSTANTIATE_TEST_SUITE_P(
    Fanuc, MalformedTables,
    ::testing::Values(
        Malformed{"fanuc", "pitch_error.txt", "VALUES COMPENSATIONS", "VALUES UP", 2, "VALUES is neither"},
        Malformed{"fanuc", "pitch_error.txt", "UNIT_UM 1", "UNIT_UM 0", 7, "missing or out of range"},
        Malformed{"fanuc", "pitch_error.txt", "LARGEST_VALUE 7\n", "", 6, "missing or out of range"},
        Malformed{"fanuc", "pitch_error.txt", "PARAMETER AXIS VALUE\n", "", 7, "PARAMETER AXIS VALUE"},
        Malformed{"fanuc", "pitch_error.txt", "3621 X 0", "3621 U 0", 11, "not a parameter of an axis"},
        Malformed{"fanuc", "pitch_error.txt", "3621 X 0", "3620 X 0", 11, "a second time"},
        Malformed{"fanuc", "pitch_error.txt", "3624 X", "3625 X", 14, "is not read here"},
        Malformed{"fanuc", "pitch_error.txt", "3624 X 500.0000\n", "", 15, "3624 is missing"},
        Malformed{"fanuc", "pitch_error.txt", "3620 X 0", "3620 X 9", 16, "out of order"},
        Malformed{"fanuc", "pitch_error.txt", "3622 X 2", "3622 X 200", 16, "more than 128"},
        Malformed{"fanuc", "pitch_error.txt", "3623 X 1", "3623 X 0", 16, "3623 or 3624"},
        Malformed{"fanuc", "pitch_error.txt", "3627 X 2", "3627 X 99999", 16, "3626 or 3627"},
        Malformed{"fanuc", "pitch_error.txt", "3626 X 3", "3626 X -3", 16, "3626 or 3627"},
        Malformed{"fanuc", "pitch_error.txt", "3626 X 3\n", "", 15, "3626, 3627 or REFERENCE_AMOUNT"},
        Malformed{"fanuc", "pitch_error.txt", "REFERENCE_AMOUNT NEGATIVE\n", "", 15, "3626, 3627 or"},
        Malformed{"fanuc", "pitch_error.txt", "\n1 -5", "\n1 -9", 33, "beyond 7"},
        Malformed{"fanuc", "pitch_error.txt", "\n1 -5", "\n1 -0.5", 33, "not a whole number"},
        Malformed{"fanuc", "pitch_error.txt", "\n2 -5", "\n1 -5", 34, "a second time"},
        Malformed{"fanuc", "pitch_error.txt", "\n2 -5", "\n2000 -5", 34, "number is out of range"},
        Malformed{"fanuc", "pitch_error.txt", "\n4 -5", "", 42, "point 4 has no value"}));

TEST(TableReaders, MissingFilesAreNamed) {
  for (const TableFormat* format : table_formats()) {
    try {
      format->read({});
      FAIL() << format->name;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("the file is missing")) << format->name;
    }
  }
}

void expect_same(const std::vector<ErrorTableRow>& read, const std::vector<ErrorTableRow>& written) {
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].symbol, written[i].symbol);
    EXPECT_EQ(read[i].axis, written[i].axis);
    EXPECT_NEAR(read[i].position, written[i].position, 1e-12);
    EXPECT_EQ(read[i].direction, written[i].direction);
    EXPECT_NEAR(read[i].value, written[i].value, 1e-14);
    EXPECT_NEAR(read[i].u, written[i].u, 1e-12);
    EXPECT_NEAR(read[i].U95, written[i].U95, 1e-12);
    EXPECT_EQ(read[i].rotation, written[i].rotation);
    EXPECT_EQ(read[i].extrapolated, written[i].extrapolated);
  }
}

TEST(NativeTables, FunctionsAreReadBackAsWritten) {
  const std::vector<ErrorTableRow> written = error_table(small_result());
  ASSERT_GT(written.size(), 100U);
  EXPECT_GT(written[1].u, 0.0);
  for (const TableContent content : {TableContent::Errors, TableContent::Compensations})
    expect_same(read_function_table({"t.csv", function_table_csv(written, content)}, content), written);
}

std::vector<std::string> cells_of_grid_row(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream row(line);
  for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
  return cells;
}

TEST(NativeTables, GridsHoldTheErrorsOfTheNodesPlaneByPlane) {
  const std::vector<VolumetricError> grid = testing::volumetric_grid(small_result(), 3, {});
  ASSERT_EQ(grid.size(), 54U);
  for (const TableContent content : {TableContent::Errors, TableContent::Compensations}) {
    const double sign = content == TableContent::Errors ? 1.0 : -1.0;
    const TableFile file = spatial_grid_file("g.csv", small_result(), 3, {}, content);
    EXPECT_EQ(std::ranges::count(file.content, '\n'), 1) << "the header alone";
    std::istringstream lines(whole_content(file));
    std::string line;
    ASSERT_TRUE(std::getline(lines, line));
    for (const VolumetricError& node : grid) {
      ASSERT_TRUE(std::getline(lines, line));
      const std::vector<std::string> cells = cells_of_grid_row(line);
      ASSERT_EQ(cells.size(), 17U);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(std::stod(cells[k]), node.position[k] * 1e3, 1e-7);
      EXPECT_EQ(cells[3], node.tool);
      for (std::size_t k = 0; k < 6; ++k) {
        const auto component = static_cast<Eigen::Index>(k);
        EXPECT_NEAR(std::stod(cells[4 + k]), sign * node.value[component] * 1e6, 1e-6);
        EXPECT_NEAR(std::stod(cells[10 + k]), node.u[component] * 1e6, 1e-6);
      }
      EXPECT_EQ(cells[16], node.extrapolated ? "1" : "0");
    }
    EXPECT_FALSE(std::getline(lines, line));
  }
}

TEST(NativeTables, MetadataStatesMachineToolAndConditions) {
  TableFormatOptions options;
  options.tool = "side";
  options.record = {"result", {{"load", "none, table empty"}, {"active_compensations", "L-POS"}}};
  const TableMetadata read =
      read_table_metadata({"metadata.csv", table_metadata_csv(small_result(), options)});
  const Machine& machine = small_result().machine;
  EXPECT_EQ(read.machine.name, machine.name);
  EXPECT_EQ(read.machine.structure.code, machine.structure.code);
  EXPECT_EQ(read.tool, "side");
  ASSERT_EQ(read.machine.tools.size(), 2U);
  for (const Tool& tool : read.machine.tools)
    EXPECT_LT((tool.offset - machine.tools[*machine.tool_index(tool.name)].offset).norm(), 1e-12);
  EXPECT_LT((read.machine.axes[0].reference_point - machine.axes[0].reference_point).norm(), 1e-12);
  EXPECT_EQ(read.entries.at("load"), "none, table empty");
  EXPECT_EQ(read.entries.at("active_compensations"), "L-POS");
  EXPECT_EQ(read.entries.at("feed"), "not recorded");
  EXPECT_EQ(read.entries.at("identification.result"), "result");
  EXPECT_EQ(read.entries.at("specific_lines.x_mm"), "500");
}

/// What takes the first tool where none is named takes that of the tables, and the others stay in their
/// order.
TEST(NativeTables, TheToolOfTheTablesIsTheFirst) {
  FitResult result = small_result();
  result.machine.tools = {
      {"short", {0.0, 0.0, -0.1}}, {"long", {0.0, 0.0, -0.2}}, {"angled", {0.1, 0.0, -0.1}}};
  const auto names = [&](const std::string& tool) {
    TableFormatOptions options;
    options.tool = tool;
    std::vector<std::string> found;
    for (const Tool& read :
         read_table_metadata({"metadata.csv", table_metadata_csv(result, options)}).machine.tools)
      found.push_back(read.name);
    return found;
  };
  EXPECT_THAT(names(""), ::testing::ElementsAre("short", "long", "angled"));
  EXPECT_THAT(names("angled"), ::testing::ElementsAre("angled", "short", "long"));
}

TEST(NativeTables, ConditionsThatAreNotAskedForAreRefused) {
  TableFormatOptions options;
  options.record.conditions["weather"] = "fine";
  EXPECT_THROW(write_tables(*find_table_format("csv"), small_result(), options), InputError);
}

}  // namespace
}  // namespace volcal
