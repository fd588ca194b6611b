// Files as the simulated control takes them: by hand for every format, and with one mistake in them.

#include "volcal/studies/files/control_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>

#include "tests/support/refusal.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/table_samples.h"
#include "volcal/identify/compensation/checks/volume_check.h"
#include "volcal/model/description/errors.h"
#include "volcal/sim/machine/random_truth.h"
#include "volcal/sim/machine/reference_machines.h"
#include "volcal/sim/machine/transforms.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;

sim::MachineState state_of(const AxisPosition& position, int direction) {
  sim::MachineState state;
  state.position = position;
  state.direction.fill(static_cast<std::int8_t>(direction));
  return state;
}

/// Added to the commands, um.
Eigen::Vector3d added_um(const char* format, const std::vector<TableFile>& files, const AxisPosition& at,
                         int direction) {
  const sim::ActiveCompensation active{control_tables(*find_table_format(format), files), 0.0, {}};
  return sim::command_correction(active)(state_of(at, direction)).linear / 1e-6;
}

constexpr AxisPosition kMiddleOfX = {0.5, 0.0, 0.0};

TEST(ControlTables, LinuxCncByHand) {
  const std::string ini = "[TRAJ]\nLINEAR_UNITS = mm\n[JOINT_0]\nCOMP_FILE = x.comp\nCOMP_FILE_TYPE = ";
  const std::vector<TableFile> trims = {{"compensation.ini", ini + "1\n"},
                                        {"x.comp", "0 0 0.002\n1000 -0.010 -0.006\n"}};
  EXPECT_NEAR(added_um("linuxcnc", trims, kMiddleOfX, 1).x(), -5.0, 1e-9);
  EXPECT_NEAR(added_um("linuxcnc", trims, kMiddleOfX, -1).x(), -2.0, 1e-9);
  const std::vector<TableFile> actual = {{"compensation.ini", ini + "0\n"},
                                         {"x.comp", "0 0 0\n1000 1000.010 1000.006\n"}};
  EXPECT_NEAR(added_um("linuxcnc", actual, kMiddleOfX, 1).x(), -5.0, 1e-6);
  const std::vector<TableFile> lathe = {
      {"compensation.ini",
       "# coordinates = XZ\n[TRAJ]\nLINEAR_UNITS = mm\n[JOINT_1]\nCOMP_FILE = z.comp\n"
       "COMP_FILE_TYPE = 1\n"},
      {"z.comp", "0 0 0\n1000 -0.010 -0.010\n"}};
  EXPECT_NEAR(added_um("linuxcnc", lathe, {0.0, 0.0, 0.5}, 1).z(), -5.0, 1e-9);
}

TEST(ControlTables, GridsByHand) {
  const std::vector<TableFile> kins = {{"volcal.grid",
                                        "# comment\nvolcal-grid-1 mm 2 1 1\n0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n"
                                        "1000 0 0 -0.008 0 0 -0.002 0 0 0 0 0 0 0 0\n"}};
  EXPECT_NEAR(added_um("linuxcnc-grid", kins, {1.0, 0.0, 0.0}, 1).x(), -10.0, 1e-9) << "half the reversal";
  EXPECT_NEAR(added_um("linuxcnc-grid", kins, {1.0, 0.0, 0.0}, -1).x(), -6.0, 1e-9);
  const std::vector<TableFile> isg = {{"volcomp.lis",
                                       "workpiece_axes 0\nX 1\ninterpolation GRID\nfile[0] volcomp.csv\n"
                                       "file_format[0] ISG_CSV\n"},
                                      {"volcomp.csv", "X EXX EZX\n0 0 0\n1000 0.010 0.004\n"}};
  EXPECT_NEAR(added_um("isg-csv", isg, kMiddleOfX, 1).x(), -5.0, 1e-9) << "errors are subtracted";
  EXPECT_NEAR(added_um("isg-csv", isg, kMiddleOfX, 1).z(), -2.0, 1e-9);
}

/// The third entry is the worked example of the manual: set 19866.7 um, actual 19856.5 um towards + and
/// 19874.7 um towards - (Beckhoff TF5200, Axis compensation, non-equidistant bilateral compensation).
TEST(ControlTables, LeadscrewByHand) {
  const std::string head =
      "kopf.achs_nr 1\nkopf.log_achs_name X\nkw.ssfk.interval 0\n"
      "kw.ssfk.kw_startpos -200000\nkw.ssfk.kw_nr_max 3\nkw.ssfk.unit 1\n"
      "kw.ssfk.bilateral 1\n";
  const std::vector<TableFile> list = {
      {"achskw1.lis", head +
                          "kw.ssfk.table[0].setpoint -200000\nkw.ssfk.table[1].setpoint 0\n"
                          "kw.ssfk.table[2].setpoint 198667\nkw.ssfk.table[0].pos 0\n"
                          "kw.ssfk.table[1].pos 0\nkw.ssfk.table[2].pos -102\n"
                          "kw.ssfk.table[0].neg 0\nkw.ssfk.table[1].neg 0\nkw.ssfk.table[2].neg 80\nEnd\n"}};
  constexpr AxisPosition kThird = {19866.7e-6, 0.0, 0.0};
  EXPECT_NEAR(added_um("isg-ssfk", list, kThird, 1).x(), 10.2, 1e-9);
  EXPECT_NEAR(added_um("isg-ssfk", list, kThird, -1).x(), -8.0, 1e-9);
  const CompensationTables own = find_table_format("isg-ssfk")->read(list);
  ApproachDirection towards_minus{};
  towards_minus.fill(-1);
  EXPECT_NEAR(own.correction(kThird, kTowardsPlus).linear.x(), 10.2e-6, 1e-15);
  EXPECT_NEAR(own.correction(kThird, towards_minus).linear.x(), -8.0e-6, 1e-15);
}

TEST(ControlTables, SinumerikByHand) {
  const std::string axis = "_STEP[0,X1]=1000\n$AA_ENC_COMP_MIN[0,X1]=0\n$AA_ENC_COMP_MAX[0,X1]=1000\n";
  const std::vector<TableFile> encoder = {
      {"AX_EEC.INI",
       "%_N_AX_EEC_INI\nCHANDATA(1)\n$AA_ENC_COMP[0,0,X1]=0\n$AA_ENC_COMP[0,1,X1]=0.010\n$AA_ENC_COMP" +
           axis + "N40 $AA_ENC_COMP_IS_MODULO[0,X1]=0 ; no turn\nM17\n"}};
  EXPECT_NEAR(added_um("sinumerik", encoder, kMiddleOfX, 1).x(), -5.0, 1e-9) << "positive moves towards -";
}

TEST(ControlTables, EtalonExchangeAndFirmwareByHand) {
  const std::vector<TableFile> etalon = {
      {"volcomp.txt", "[EYX]\nGridpoints = {\n0 0\n1000 0.010 // far end\n}\n"}};
  EXPECT_NEAR(added_um("etalon-exchange", etalon, kMiddleOfX, 1).y(), -5.0, 1e-9);
  const std::vector<TableFile> marlin = {{"skew.gcode", "G21\nM852 I0.00003 J0 K0\nM500\n"}};
  EXPECT_NEAR(added_um("marlin", marlin, {0.0, 1.0, 0.0}, 1).x(), -30.0, 1e-6);
  const std::vector<TableFile> klipper = {
      {"skew_correction.cfg", "[skew_correction volcal]\nxy_skew = 0\nxz_skew = 0.00002\nyz_skew = 0\n"}};
  EXPECT_NEAR(added_um("klipper", klipper, {0.0, 0.0, 1.0}, 1).x(), -20.0, 1e-9);
}

TEST(ControlTables, TypedTablesByHand) {
  const std::vector<TableFile> heidenhain = {
      {"CONFIG.CMA.txt", "ACTIVE X\n* X.COM\n"},
      {"X.COM.txt", "; VOLCAL VALUES ARE ERRORS\nAXISPOS X Z\n0 0 0\n1000 0.010 0.004\n"}};
  EXPECT_NEAR(added_um("heidenhain", heidenhain, kMiddleOfX, 1).x(), -5.0, 1e-9);
  EXPECT_NEAR(added_um("heidenhain", heidenhain, kMiddleOfX, 1).z(), -2.0, 1e-9);
  const std::string fanuc =
      "VALUES COMPENSATIONS\nOUTPUT EVEN\nDETECTION_UNIT_UM 0.1\nLARGEST_VALUE 7\n"
      "REFERENCE_AMOUNT NEGATIVE\nPARAMETER AXIS VALUE\nREFERENCE X 1000\n3605#0 X 1\n3620 X 11\n"
      "3621 X 11\n3622 X 11\n3623 X 20\n3624 X 1000\n3626 X 21\n3627 X -30\nNUMBER VALUE\n11 5\n21 2\n";
  EXPECT_NEAR(added_um("fanuc", {{"pitch_error.txt", fanuc}}, kMiddleOfX, 1).x(), -5.0, 1e-9)
      << "5 x 20 x 0.1 um less at the far end of the interval below the reference position";
  EXPECT_NEAR(added_um("fanuc", {{"pitch_error.txt", fanuc}}, kMiddleOfX, -1).x(), -2.0 - 3.0, 1e-9);
}

/// Every type, also where the frame turns: tables and products against the ideal compensation, no alignment.
TEST(ControlTables, ProductsOfTablesAreTheIdealCompensation) {
  const TableFormat& format = *find_table_format("sinumerik-cec");
  for (std::size_t structure = 0; structure < 3; ++structure) {
    sim::RandomTruthOptions truth_options;
    truth_options.reversal_max = 4e-6;
    truth_options.angular_reversal_max = 3e-6;
    const sim::TruthMachine truth =
        sim::random_truth(sim::reference_machines()[structure], 40 + structure, truth_options);
    const FitResult result = testing::result_of(truth, 20);
    for (const CompensationTypeInfo& info : compensation_types()) {
      if (!info.type.rotary().empty()) continue;
      TableFormatOptions options;
      options.type = info.type;
      options.tool = "side_x";
      options.step = structure == 2 ? 13e-3 : 10e-3;  // X of 2.5 m, in 200 positions
      options.settings = testing::example_settings(format);
      const auto control =
          sim::command_correction({control_tables(format, write_tables(format, result, options)), 0.0, {}});
      const Compensation ideal = ideal_compensation(result, options);
      // Middles of quarters are middles of the functions' straight pieces: no kink between two positions.
      for (const VolumePoint& point : volume_lattice(truth.machine(), 4)) {
        sim::MachineState state;
        state.position = point.position;
        state.direction = point.direction;
        EXPECT_LT((control(state).linear - ideal.correction(point.position, point.direction)).norm(), 0.02e-6)
            << truth.machine().structure.code << " " << info.name;
      }
    }
  }
}

/// Two readers that know nothing of each other agree on every format and type.
TEST(ControlTables, AgreeWithTheFormatsOwnReader) {
  for (const TableFormat* format : table_formats()) {
    if (!control_reads(*format)) continue;
    for (const CompensationTypeInfo& info : compensation_types()) {
      if (!testing::holds(*format, info.type)) continue;
      const auto files = testing::sample_tables(*format, info.type);
      const CompensationTables own = format->read(files);
      const sim::ActiveCompensation active{control_tables(*format, files), 0.0, {}};
      const auto control = sim::command_correction(active);
      for (const VolumePoint& point : volume_points(testing::small_result().machine, 3)) {
        sim::MachineState state;
        state.position = point.position;
        state.direction = point.direction;
        EXPECT_LT((control(state).linear - own.correction(point.position, point.direction).linear).norm(),
                  2e-9)
            << format->name << " " << info.name;
      }
    }
  }
}

TEST(ControlTables, AFolderTellsItsFormat) {
  for (const TableFormat* format : table_formats()) {
    if (!control_reads(*format)) continue;
    testing::ScratchFolder scratch;
    for (const TableFile& file : testing::sample_tables(*format))
      std::ofstream(scratch.path() / file.name) << file.content;
    const bool pivots = format->name == "linuxcnc-trt";  // without any its folder is one of linuxcnc
    EXPECT_EQ(read_tables_folder(scratch.path().string()).format,
              pivots ? find_table_format("linuxcnc") : format)
        << format->name;
  }
  testing::ScratchFolder empty;
  EXPECT_THROW(read_tables_folder(empty.path().string()), InputError);
  EXPECT_THROW(read_tables_folder((empty.path() / "none").string()), InputError);
}

/// A file that no reader of the folder's format would look at belongs to another one.
TEST(ControlTables, AFolderOfTwoFormatsIsRefused) {
  const std::vector<std::vector<const char*>> folders = {{"volcal.grid", "skew.gcode"},
                                                         {"compensation.ini", "volcal.rotary"},
                                                         {"volcal.grid", "pivots.hal"},
                                                         {"compensation_tables.csv", "correction_grid.csv"},
                                                         {"compensation_tables.csv", "axis_corrections.csv"}};
  for (const std::vector<const char*>& names : folders) {
    testing::ScratchFolder folder;
    for (const char* name : names) std::ofstream(folder.path() / name) << "x\n";
    EXPECT_THAT(testing::refusal([&] { read_tables_folder(folder.path().string()); }),
                HasSubstr("two formats"))
        << names.back();
  }
}

TEST(ControlTables, RefusesFilesThatTheFormatRefuses) {
  EXPECT_THROW(control_tables(*find_table_format("linuxcnc-grid"),
                              std::vector<TableFile>{{"volcal.grid", "volcal-grid-1 mm 2 2 2\n0 0 0\n"}}),
               InputError);
}

// ---- Files with one mistake: the machine that applies them must show it.

/// Where the values of a format stand: cells `first` to `last` of the lines that begin with `prefix`.
struct ValueCells {
  const char* format;
  const char* file_end;
  char separator;
  std::size_t first, last;
  const char* prefix;
};

constexpr ValueCells kValueCells[] = {
    {"csv", "compensation_tables.csv", ',', 5, 5, "E"},
    {"neutral-csv", "correction_grid.csv", ',', 3, 14, ""},
    {"linuxcnc", ".comp", ' ', 1, 2, ""},
    {"linuxcnc-grid", "volcal.grid", ' ', 3, 14, ""},
    {"klipper", "skew_correction.cfg", '=', 1, 1, "x"},
    {"marlin", "skew.gcode", '=', 1, 1, "none"},
    {"isg-csv", "volcomp.csv", ' ', 3, 5, ""},
    {"etalon-exchange", "volcomp.txt", ' ', 1, 1, ""},
    {"isg-ssfk", ".lis", ' ', 1, 1, "kw.ssfk.table["},
    {"sinumerik", "AX_EEC.INI", '=', 1, 1, "$AA_ENC_COMP["},
    {"sinumerik-cec", "NC_CEC.INI", '=', 1, 1, "$AN_CEC["},
    {"heidenhain", ".COM.txt", ' ', 1, 3, ""},
    {"fanuc", "pitch_error.txt", ' ', 1, 1, ""},
};

/// Two words of a file that could be mistaken for each other, and which mistake that is.
struct Exchange {
  const char* format;
  const char* mistake;
  const char* one;
  const char* other;
};

constexpr Exchange kExchanges[] = {
    {"csv", "axis", "EBX,", "ECX,"},
    {"csv", "squareness", "EB0Z", "EA0Z"},
    {"csv", "direction", ",mm,1,", ",mm,-1,"},
    {"csv", "tool", "tool,side_x", "tool,side_y"},
    {"linuxcnc", "axis", "x.comp", "y.comp"},
    {"linuxcnc", "unit", "LINEAR_UNITS = mm", "LINEAR_UNITS = inch"},
    {"linuxcnc", "type", "COMP_FILE_TYPE = 1", "COMP_FILE_TYPE = 0"},
    {"linuxcnc-grid", "unit", "volcal-grid-1 mm", "volcal-grid-1 inch"},
    {"klipper", "axis", "xy_skew", "yz_skew"},
    {"marlin", "axis", " I", " K"},
    {"isg-csv", "axis", "EXX", "EYY"},
    {"etalon-exchange", "axis", "[EXX]", "[EYY]"},
    {"etalon-exchange", "index", "[EYX]", "[EXY]"},
    {"isg-ssfk", "axis", "log_achs_name X", "log_achs_name Y"},
    {"isg-ssfk", "direction", "].pos", "].neg"},
    {"sinumerik", "axis", ",X1]", ",Y1]"},
    {"sinumerik-cec", "axis", "OUTPUT_AXIS[0]=(Y1)", "OUTPUT_AXIS[0]=(X1)"},
    {"sinumerik-cec", "index", "INPUT_AXIS[2]=(X1)", "INPUT_AXIS[2]=(Z1)"},
    {"sinumerik-cec", "direction", "DIRECTION[2]=1", "DIRECTION[2]=-1"},
    {"sinumerik-cec", "factor", "]=1\n$AN_CEC_IS_MODULO", "]=2\n$AN_CEC_IS_MODULO"},
    {"sinumerik-cec", "sign", "VALUES ARE ERRORS", "VALUES ARE COMPENSATIONS"},
    {"heidenhain", "axis", "AXISPOS X Y", "AXISPOS Y X"},
    {"heidenhain", "cause", "* X.COM Y.COM", "* Y.COM X.COM"},
    {"heidenhain", "sign", "VALUES ARE ERRORS", "VALUES ARE COMPENSATIONS"},
    {"fanuc", "axis", " X ", " Y "},
    {"fanuc", "direction", "REFERENCE_AMOUNT NEGATIVE", "REFERENCE_AMOUNT POSITIVE"},
    {"fanuc", "unit", "DETECTION_UNIT_UM 1", "DETECTION_UNIT_UM 10"},
    {"fanuc", "sign", "VALUES COMPENSATIONS", "VALUES ERRORS"},
};

std::string exchanged(const std::string& text, const std::string& one, const std::string& other) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    if (text.compare(i, one.size(), one) == 0) {
      result += other;
      i += one.size();
    } else if (text.compare(i, other.size(), other) == 0) {
      result += one;
      i += other.size();
    } else {
      result += text[i++];
    }
  }
  return result;
}

using CellChange = std::function<void(std::vector<std::string>& cells, const ValueCells& where)>;

bool is_number(const std::string& cell) {
  return !cell.empty() && cell.find_first_not_of(" +-.0123456789e") == std::string::npos;
}

std::string with_cells(const std::string& text, const ValueCells& where, const CellChange& change) {
  std::istringstream lines(text);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, where.separator);) cells.push_back(cell);
    const bool values =
        line.starts_with(where.prefix) && cells.size() > where.last && is_number(cells[where.last]);
    if (values) change(cells, where);
    for (std::size_t i = 0; i < cells.size(); ++i)
      result += (i ? std::string(1, where.separator) : "") + cells[i];
    result += '\n';
  }
  return result;
}

CellChange scaled_by(double factor) {
  return [factor](std::vector<std::string>& cells, const ValueCells& where) {
    for (std::size_t i = where.first; i <= where.last; ++i) {
      std::ostringstream text;
      text.precision(12);
      text << std::stod(cells[i]) * factor;
      cells[i] = text.str();
    }
  };
}

/// The first two values of a row, which are two axes or two directions.
void exchange_cells(std::vector<std::string>& cells, const ValueCells& where) {
  if (where.last > where.first) std::swap(cells[where.first], cells[where.first + 1]);
}

/// Reversals of a grid, which begin behind the means.
void negate_reversals(std::vector<std::string>& cells, const ValueCells& where) {
  ValueCells reversals = where;
  reversals.first = 6;
  if (where.last == 14) scaled_by(-1.0)(cells, reversals);
}

class MistakenFiles : public ::testing::TestWithParam<const TableFormat*> {
 protected:
  MistakenFiles() : truth_(machine()), result_(testing::result_of(truth_, 20)) {}

  static sim::TruthMachine machine() {
    sim::RandomTruthOptions options;
    options.reversal_max = 6e-6;
    options.angular_reversal_max = 6e-6;
    return sim::random_truth(sim::reference_machines()[1], 9, options);
  }

  TableFormatOptions options(const char* tool = "side_x") const {
    TableFormatOptions options;
    options.type = GetParam()->supported;
    options.tool = tool;
    options.step = 25e-3;
    options.grid_per_axis = 2;
    options.settings = testing::example_settings(*GetParam());
    return options;
  }

  /// What the files add beside what the right ones add, RMS over the volume after alignment, m; infinite when
  /// the files are refused.
  double deviation(const std::vector<TableFile>& files) const {
    try {
      const auto right = sim::command_correction({control_tables(*GetParam(), right_files()), 0.0, {}});
      const auto wrong = sim::command_correction({control_tables(*GetParam(), files), 0.0, {}});
      std::vector<Eigen::Vector3d> points, differences;
      for (const VolumePoint& point : volume_points(truth_.machine(), 4)) {
        sim::MachineState state;
        state.position = point.position;
        state.direction = point.direction;
        points.emplace_back(point.position[0], point.position[1], point.position[2]);
        differences.emplace_back(wrong(state).linear - right(state).linear);
      }
      return sim::rms_after_alignment(points, differences);
    } catch (const InputError&) {
      return HUGE_VAL;
    }
  }

  std::vector<TableFile> right_files() const { return write_tables(*GetParam(), result_, options()); }

  void expect_seen(const std::vector<TableFile>& files, const std::string& mistake) const {
    bool changed = false;
    const auto right = right_files();
    for (std::size_t i = 0; i < files.size(); ++i) changed = changed || files[i].content != right[i].content;
    EXPECT_TRUE(changed) << GetParam()->name << ": nothing is " << mistake;
    EXPECT_GT(deviation(files), kSeen) << GetParam()->name << ": " << mistake;
  }

  static constexpr double kSeen = 0.3e-6;  // m: more than any step or digit
  sim::TruthMachine truth_;
  FitResult result_;
};

TEST_P(MistakenFiles, WrongSignUnitOrColumnShowsOnTheMachine) {
  const auto* found = std::ranges::find_if(
      kValueCells, [](const ValueCells& cells) { return cells.format == GetParam()->name; });
  if (found == std::end(kValueCells)) GTEST_SKIP() << "no mistakes are listed for this format";
  const ValueCells& where = *found;
  const auto with = [&](const CellChange& change) {
    std::vector<TableFile> files = right_files();
    for (TableFile& file : files) {
      if (file.name.ends_with(where.file_end)) file.content = with_cells(file.content, where, change);
    }
    return files;
  };
  if (std::string(where.prefix) == "none") return;  // Marlin: by exchanges below
  expect_seen(with(scaled_by(-1.0)), "the sign");
  expect_seen(with(scaled_by(1000.0)), "the unit, mm as um");
  expect_seen(with(scaled_by(1e-3)), "the unit, um as mm");
  expect_seen(with(scaled_by(1.0 / 25.4)), "the unit, inches");
  expect_seen(with(scaled_by(1.2)), "the magnitude");
  if (where.last > where.first) expect_seen(with(exchange_cells), "the first two columns");
  if (where.last == 14) expect_seen(with(negate_reversals), "the directions");
}

TEST_P(MistakenFiles, ExchangedNamesShowOnTheMachine) {
  for (const Exchange& exchange : kExchanges) {
    if (exchange.format != GetParam()->name) continue;
    std::vector<TableFile> files = right_files();
    for (TableFile& file : files) file.content = exchanged(file.content, exchange.one, exchange.other);
    expect_seen(files, exchange.mistake);
  }
}

TEST_P(MistakenFiles, TablesOfAnotherToolShowOnTheMachine) {
  if (!control_reads(*GetParam()) || !GetParam()->supported.has(CompensationPart::Angular)) return;
  expect_seen(write_tables(*GetParam(), result_, options("side_y")), "for another tool");
}

INSTANTIATE_TEST_SUITE_P(All, MistakenFiles, ::testing::ValuesIn(table_formats()), [](const auto& tested) {
  std::string name(tested.param->name);
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
}  // namespace volcal
