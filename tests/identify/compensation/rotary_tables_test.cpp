// Tables of rotary axes: written, read back by the rules of their control, and refused where damaged.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "tests/support/five_axis.h"
#include "tests/support/refusal.h"
#include "tests/support/rotary_machines.h"
#include "tests/support/table_samples.h"
#include "volcal/identify/compensation/checks/made_tables.h"
#include "volcal/identify/compensation/five_axis_compensation.h"
#include "volcal/identify/compensation/rotary_grid_csv.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/errors/stated_errors.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/effects/effect_keys.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using testing::rotary_result;

TableFormatOptions rotary_options(const char* type, double step_deg = 10.0) {
  TableFormatOptions options;
  options.type = CompensationType::parse(type);
  options.step = 0.3;
  options.grid_per_axis = 2;
  options.rotary_step = step_deg * kRadianPerDegree;
  return options;
}

std::vector<TableFile> rotary_files(const char* format, const FitResult& result, TableFormatOptions options) {
  options.settings = testing::example_settings(*find_table_format(format));
  return write_tables(*find_table_format(format), result, options);
}

FiveAxisCompensation ideal_rotary(const FitResult& result, CompensationType type) {
  FiveAxisSettings settings;
  settings.type = type.rotary();
  settings.tool_offset = result.machine.tools.front().offset;
  return {result.machine, settings,
          joint_errors(result, result.machine.tools.front(), default_conditions(result))};
}

/// Poses whose rotary axes stand at multiples of 10 degrees, where no table interpolates.
std::vector<AxisPosition> poses_at_nodes(const Machine& machine) {
  std::mt19937_64 random(8);
  std::vector<AxisPosition> poses;
  for (int i = 0; i < 60; ++i) {
    AxisPosition pose{};
    for (const Axis& axis : machine.axes) {
      const int tens = axis.name == AxisName::C ? 17 : 11;
      pose[index_of(axis.name)] =
          is_rotary(axis.name)
              ? std::uniform_int_distribution<int>(-tens, tens)(random) * 10.0 * kRadianPerDegree
              : testing_support::uniform(random, 0.3);
    }
    poses.push_back(pose);
  }
  return poses;
}

struct RotaryCase {
  const char* format;
  const char* type;
  const char* structure;
};

class RotaryTables : public ::testing::TestWithParam<RotaryCase> {};

TEST_P(RotaryTables, ReadBackTheyAreTheIdealCompensation) {
  const FitResult result = rotary_result(GetParam().structure);
  const TableFormatOptions options = rotary_options(GetParam().type);
  const TableFormat& format = *find_table_format(GetParam().format);
  const CompensationTables tables = format.read(rotary_files(GetParam().format, result, options));
  const FiveAxisCompensation ideal = ideal_rotary(result, options.type);
  double largest = 0.0;
  for (const AxisPosition& pose : poses_at_nodes(result.machine)) {
    const Correction read = tables.correction(pose, {}), expected = ideal.correction(pose);
    largest = std::max({largest, expected.linear.norm(), expected.rotary.norm() * 0.1});
    EXPECT_LT((read.linear - expected.linear).norm(), 1e-9);
    EXPECT_LT((read.rotary - expected.rotary).norm(), 1e-9);
  }
  EXPECT_GT(largest, 1e-6);
  const auto check = check_rotary_axes(format, result, options, tables);
  ASSERT_TRUE(check.has_value());
  EXPECT_GT(check->before.rms, 10e-6);
  EXPECT_NEAR(check->exported.rms, check->ideal.rms, 0.4e-6);
  EXPECT_NEAR(check->exported.axis_rms, check->ideal.axis_rms, 0.4e-6);
}

INSTANTIATE_TEST_SUITE_P(All, RotaryTables,
                         ::testing::Values(RotaryCase{"csv", "L-VOL+R-VOL", testing::kTrunnion},
                                           RotaryCase{"csv", "L-VOL+R-VOL", testing::kHead},
                                           RotaryCase{"neutral-csv", "R-VOL", testing::kTrunnion},
                                           RotaryCase{"neutral-csv", "R-VOL", testing::kHead},
                                           RotaryCase{"neutral-csv", "L-VOL+R-VOL", testing::kMixed},
                                           RotaryCase{"neutral-csv", "L-POS+R-POR", testing::kTrunnion},
                                           RotaryCase{"neutral-csv", "R-POS", testing::kMixed},
                                           RotaryCase{"linuxcnc-grid", "R-VOL", testing::kTrunnion},
                                           RotaryCase{"linuxcnc-grid", "L-VOL+R-VOL", testing::kHead},
                                           RotaryCase{"linuxcnc-grid", "R-POS+R-POR", testing::kMixed},
                                           RotaryCase{"isg-csv", "R-RAX+R-POR+R-ANG", testing::kTrunnion},
                                           RotaryCase{"isg-csv", "L-VOL+R-POR", testing::kHead},
                                           RotaryCase{"sinumerik", "L-POS+R-POS", testing::kTrunnion},
                                           RotaryCase{"sinumerik", "R-POS", testing::kHead}));

/// A table that turns back by 30 urad less than it went: the mean of both directions takes none of it.
TEST(RotaryTablesOfReversals, SayWhatTheirMeanOfDirectionsLeaves) {
  const Machine machine = testing_support::five_axis_machine(testing::kTrunnion);
  ModelSpec model;
  model.default_function.basis = "zero";
  FunctionSpec turn;
  turn.basis = "fourier";
  turn.degree = 1;
  turn.coefficients = {0.0, 0.0, 0.0};
  for (const char* symbol : {"ECC", "EAA"}) model.functions[*ErrorSymbol::parse(symbol)] = turn;
  model.effects = {effect_spec("reversal", {{"symbol", std::string("ECC")}, {"amplitude", 30e-6}})};
  const FitResult result = stated_result(machine, model);
  for (const bool by_direction : {false, true}) {
    const std::string name = by_direction ? "neutral-csv" : "csv";
    const TableFormatOptions options = rotary_options("L-VOL+R-VOL");
    const TableFormat& format = *find_table_format(name);
    const CompensationTables tables = format.read(write_tables(format, result, options));
    const RotaryCheck check = *check_rotary_axes(format, result, options, tables);
    EXPECT_GT(check.before.rms, 1e-6);
    EXPECT_LT(check.ideal.rms, 0.01e-6);
    EXPECT_NEAR(check.exported.rms, by_direction ? 0.0 : check.before.rms, 0.02 * check.before.rms) << name;
    EXPECT_NEAR(check.without_directions, check.exported.rms, 0.05e-6) << name;
  }
}

/// EC0C = 80 urad alone, A at 90 degrees. The functional point (110, 0, -200) is (110, 290, 40) mm where the
/// cradle carries it, turned about its centre (0, 10, 50), and (100, 310) from the centre of C less its 20
/// mm: (100, 280) mm about (10, -20), y = 10 + 250 = 260. The turn displaces it by 80 urad x (-280, 100) mm
/// there, which is (-22.4, 0, -8) um in X, Y, Z.
TEST(RotaryTablesOfIsg, KnowWhereAnAxisWithoutErrorsStands) {
  const Machine machine = testing::rotary_machine(testing::kTrunnion);
  const FitResult result = testing::result_with(machine, {.locations = {{"EC0C", 80e-6}}}, 4);
  const TableFormatOptions options = rotary_options("R-VOL");
  const TableFormat& format = *find_table_format("isg-csv");
  const CompensationTables tables = format.read(rotary_files("isg-csv", result, options));
  AxisPosition at{};
  at[0] = 0.11;
  at[index_of(AxisName::A)] = 90.0 * kRadianPerDegree;
  const Eigen::Vector3d moved = tables.correction(at, {}).linear;
  EXPECT_LT((moved - Eigen::Vector3d(22.4e-6, 0.0, 8e-6)).norm(), 1e-11) << moved.transpose();
  EXPECT_LT(check_rotary_axes(format, result, options, tables)->deviation, 0.01e-6);
}

/// The control moves X, Y and Z for what R-POS corrects.
TEST(RotaryTablesOfIsg, AreNotOffTheIdealWhereTheyTurnNoAxis) {
  for (const char* structure : {testing::kTrunnion, testing::kHead, testing::kMixed}) {
    const FitResult result = rotary_result(structure);
    TableFormatOptions options = rotary_options("L-VOL+R-VOL");
    const TableFormat& format = *find_table_format("isg-csv");
    options.settings = testing::example_settings(format);
    const CompensationTables tables = format.read(write_tables(format, result, options));
    EXPECT_LT(deviation_of(format, result, options, tables), 0.01e-6) << structure;
    options.type = CompensationType::rotary_volumetric();
    options.step = 0.0;
    EXPECT_TRUE(make_tables(format, result, options).step.reached) << structure;
  }
}

struct OfLinearSteps {
  const char* format;
  const char* type;
};

class RotaryTablesBesideLinearOnes : public ::testing::TestWithParam<OfLinearSteps> {};

/// A wave of X that is zero at every position of the tables, and a reversal that tables of one direction
/// leave.
TEST_P(RotaryTablesBesideLinearOnes, AreNotJudgedByWhatTheseLeave) {
  const auto wave = [](double q) { return 6e-6 * std::sin(2.0 * std::numbers::pi * q / 0.3); };
  const FitResult result = testing::result_with(
      testing::rotary_machine(testing::kTrunnion),
      {.functions = {{"EXX", wave}, {"EYX", wave}, {"ECC", [](double q) { return 30e-6 * std::sin(q); }}},
       .reversals = {{"EXX", 4e-6}}},
      36);
  const TableFormat& format = *find_table_format(GetParam().format);
  TableFormatOptions options = rotary_options(GetParam().type, 0.0);
  options.settings = testing::example_settings(format);
  const MadeTables made = make_tables(format, result, options);
  EXPECT_GT(made.check.exported.max, 4e-6) << "left by the tables of X";
  EXPECT_GT(made.rotary_check->before.rms, 1e-6);
  EXPECT_NEAR(made.rotary_check->exported.rms, made.rotary_check->ideal.rms, 0.1e-6);
  EXPECT_LT(made.rotary_check->without_directions, 0.1e-6);
  EXPECT_EQ(made.options.rotary_step, 0.0) << "no finer step is needed";
  const auto said = [&](FindingCode code) {
    return std::ranges::count(made.cautions, code, &Finding::code) > 0;
  };
  EXPECT_FALSE(said(FindingCode::RotaryTablesOffIdeal));
  EXPECT_FALSE(said(FindingCode::RotaryTablesWithoutDirections));
}

INSTANTIATE_TEST_SUITE_P(All, RotaryTablesBesideLinearOnes,
                         ::testing::Values(OfLinearSteps{"neutral-csv", "L-VOL+R-VOL"},
                                           OfLinearSteps{"linuxcnc-grid", "L-VOL+R-VOL"},
                                           OfLinearSteps{"isg-csv", "L-VOL+R-VOL"},
                                           OfLinearSteps{"sinumerik", "L-POS+R-POS"}),
                         [](const auto& given) {
                           std::string name = given.param.format;
                           std::erase(name, '-');
                           return name;
                         });

TEST(RotaryTableTypes, AreWhatTheFormatHoldsOfTheMachine) {
  const FitResult result = rotary_result(testing::kTrunnion);
  EXPECT_EQ(default_type(*find_table_format("csv"), result).name(), "L-VOL+R-VOL");
  EXPECT_EQ(default_type(*find_table_format("sinumerik"), result).name(), "L-POS+R-POS");
  EXPECT_EQ(default_type(*find_table_format("linuxcnc"), result).name(), "L-POS");
  EXPECT_EQ(default_type(*find_table_format("csv"), testing::small_result()).name(), "L-VOL");
  const auto message = [&](const char* format, const char* type, const FitResult& of) {
    return testing::refusal([&] { rotary_files(format, of, rotary_options(type)); });
  };
  EXPECT_THAT(message("linuxcnc", "R-POS", result), HasSubstr("holds nothing of rotary axes"));
  EXPECT_THAT(message("etalon-exchange", "L-POS+R-POS", result), HasSubstr("holds nothing of rotary axes"));
  for (const char* format : {"klipper", "marlin", "isg-ssfk", "sinumerik-cec"})
    EXPECT_THAT(message(format, "R-VOL", result), HasSubstr("holds nothing of rotary axes")) << format;
  for (const char* format : {"heidenhain", "fanuc"})
    EXPECT_THAT(message(format, "R-POR", result), HasSubstr("of rotary axes it holds R-POS")) << format;
  for (const char* format : {"isg-csv", "linuxcnc-grid"})
    EXPECT_THAT(message(format, "R-RAX", result), HasSubstr("R-RAX and R-ANG together")) << format;
  EXPECT_THAT(message("csv", "L-VOL+R-POS", result), HasSubstr("R-VOL as a whole"));
  EXPECT_THAT(message("sinumerik", "R-POR", result), HasSubstr("of rotary axes it holds R-POS"));
  for (const char* type : {"FOR", "L-VOL+", "R-VOL+"})
    EXPECT_THAT(message("neutral-csv", type, result), HasSubstr("which no table holds")) << type;
  EXPECT_THAT(message("neutral-csv", "R-VOL", testing::small_result()),
              HasSubstr("no error of a rotary axis was identified"));
  EXPECT_THAT(message("neutral-csv", "R-RAX", result), HasSubstr("R-RAX and R-ANG together"));
}

TEST(RotaryTableTypes, WhatIsLeftOutIsSaid) {
  const FitResult result = rotary_result(testing::kTrunnion);
  const auto codes = [&](const char* format, const char* type) {
    std::vector<FindingCode> all;
    for (const Finding& finding :
         make_tables(*find_table_format(format), result, rotary_options(type)).effects_left_out)
      all.push_back(finding.code);
    return all;
  };
  EXPECT_TRUE(codes("csv", "L-VOL+R-VOL").empty());
  EXPECT_EQ(codes("csv", "L-VOL"), std::vector(2, FindingCode::RotaryErrorsInNoTable));
  EXPECT_EQ(codes("sinumerik", "L-POS+R-POS"), std::vector(2, FindingCode::RotaryErrorsPartlyInTables));
  EXPECT_EQ(codes("linuxcnc", "L-POS"), std::vector(2, FindingCode::RotaryErrorsInNoTable));
}

/// ECC = 10 urad at 90 degrees: the command is made 10 urad smaller there; SINUMERIK holds the error, in deg:
/// 10e-6 x 180 / pi = 0.000573.
TEST(RotaryTableSigns, OnOnePoint) {
  const Machine machine = testing::rotary_machine("w C' b X Y Z t");
  const FitResult result = testing::result_with(
      machine, {.functions = {{"ECC", [](double q) { return 10e-6 * std::sin(q); }}}}, 36);
  const TableFormatOptions options = rotary_options("R-POS");
  const auto neutral = rotary_files("neutral-csv", result, options);
  ASSERT_EQ(neutral.size(), 1U);
  EXPECT_THAT(neutral[0].content, HasSubstr("\nC,90,-10,-10,1\n"));
  const auto sinumerik = rotary_files("sinumerik", result, options);
  EXPECT_THAT(sinumerik[0].content, HasSubstr("$AA_ENC_COMP[0,9,C1]=0.00057296\n"));
  EXPECT_THAT(sinumerik[0].content, HasSubstr("$AA_ENC_COMP[0,27,C1]=-0.00057296\n"));
  EXPECT_THAT(sinumerik[0].content, HasSubstr("$AA_ENC_COMP_MIN[0,C1]=0.000000\n"
                                              "$AA_ENC_COMP_MAX[0,C1]=360.000000\n"
                                              "$AA_ENC_COMP_IS_MODULO[0,C1]=1\n"));
  for (const char* format : {"neutral-csv", "sinumerik"}) {
    const CompensationTables tables = find_table_format(format)->read(rotary_files(format, result, options));
    for (const double turns : {-1.0, 0.0, 1.0}) {
      const AxisPosition at = {0, 0, 0, 0, 0, (90.0 + 360.0 * turns) * kRadianPerDegree};
      EXPECT_NEAR(tables.correction(at, {}).rotary.z(), -10e-6, 2e-10) << format;
    }
  }
  const auto csv = rotary_files("csv", result, rotary_options("L-VOL+R-VOL"));
  EXPECT_THAT(find_file(csv, "error_tables.csv")->content, HasSubstr("\nECC,C,90,deg,0,10,urad,"));
  EXPECT_THAT(find_file(csv, "compensation_tables.csv")->content, HasSubstr("\nECC,C,90,deg,0,-10,urad,"));
  EXPECT_THAT(find_file(csv, "rotary_error_grid_table.csv")->content, HasSubstr("\n90,0,0,0,0,0,10,"));
  EXPECT_THAT(find_file(csv, "rotary_compensation_grid_table.csv")->content,
              HasSubstr("\n90,0,0,0,0,0,-10,"));
  EXPECT_THAT(find_file(csv, "metadata.csv")->content, HasSubstr("compensation_type,L-VOL+R-VOL\n"));
}

TEST(RotaryGridFile, SaysWhatItHolds) {
  const auto files = rotary_files("csv", rotary_result(testing::kTrunnion), rotary_options("L-VOL+R-VOL"));
  const std::string& text = find_file(files, "rotary_compensation_grid_table.csv")->content;
  for (const char* line :
       {"# content = compensation\n", "# body = table\n", "# reference_point_mm = 10 -20 0\n",
        "# axes = A C\n", "# beyond_ends.A = end values held\n", "# beyond_ends.C = modulo 360 deg\n",
        "# own_rotations = included\n",
        "a_deg,c_deg,dx_um,dy_um,dz_um,da_urad,db_urad,dc_urad,u_ex_um,u_ey_um,u_ez_um,u_ea_urad,u_eb_urad,"
        "u_ec_urad,extrapolated\n"})
    EXPECT_THAT(text, HasSubstr(line));
}

TEST(RotaryGridFile, ComesBackAsItWas) {
  const FitResult result = rotary_result(testing::kTrunnion);
  for (const RotaryGrid& grid : rotary_grids(result, default_conditions(result), 10.0 * kRadianPerDegree)) {
    for (const TableContent content : {TableContent::Errors, TableContent::Compensations}) {
      const TableFile file{rotary_grid_file_name(grid.body, content), rotary_grid_csv(grid, content, true)};
      const RotaryGrid read = read_rotary_grid(file, content);
      EXPECT_EQ(read.body, grid.body);
      EXPECT_LT((read.reference - grid.reference).norm(), 1e-15);
      ASSERT_EQ(read.twists.size(), grid.twists.size());
      for (std::size_t i = 0; i < grid.twists.size(); ++i) {
        EXPECT_LT((read.twists[i].value - grid.twists[i].value).cwiseAbs().maxCoeff(), 1e-13);
        EXPECT_LT((read.twists[i].u - grid.twists[i].u).cwiseAbs().maxCoeff(), 1e-11);
      }
      EXPECT_EQ(rotary_grid_csv(read, content, true), file.content);
    }
  }
}

/// Bilinear between nodes: RMS at 200 mm of tool and up to 0.3 m of travel.
TEST(RotaryGridFile, InterpolationErrorGrowsWithTheSquareOfTheStep) {
  const FitResult result = rotary_result(testing::kTrunnion);
  const FiveAxisCompensation ideal = ideal_rotary(result, CompensationType::parse("R-RAX+R-POR+R-ANG"));
  const Eigen::Vector3d tool = result.machine.tools.front().offset;
  const auto off = [&](double step_deg) {
    const auto term = rotary_grid_term(
        rotary_grids(result, default_conditions(result), step_deg * kRadianPerDegree, {.own = false}),
        result.machine, tool);
    double square = 0.0;
    const auto poses = poses_of_all_axes(result.machine, 400);
    for (const AxisPosition& pose : poses)
      square += (term(pose, {}).linear - ideal.correction(pose).linear).squaredNorm();
    return std::sqrt(square / static_cast<double>(poses.size())) / 1e-6;
  };
  const double at_5 = off(5.0), at_10 = off(10.0), at_30 = off(30.0);
  EXPECT_LT(at_5, 0.1);
  EXPECT_LT(at_10, 0.25);
  EXPECT_GT(at_30, 4.0 * at_10);
}

struct DamagedRotary {
  const char* format;
  const char* file;
  const char* from;
  const char* to;
  const char* problem;
};

class DamagedRotaryTables : public ::testing::TestWithParam<DamagedRotary> {};

TEST_P(DamagedRotaryTables, AreRefusedWithFileAndRemedy) {
  const DamagedRotary& broken = GetParam();
  const TableFormat& format = *find_table_format(broken.format);
  const FitResult result = rotary_result(testing::kTrunnion);
  auto files =
      rotary_files(broken.format, result, rotary_options(default_type(format, result).name().c_str()));
  std::string* content = nullptr;
  for (TableFile& file : files) {
    if (file.name == broken.file) content = &file.content;
  }
  ASSERT_NE(content, nullptr) << broken.file;
  const auto place = content->find(broken.from);
  ASSERT_NE(place, std::string::npos) << *content;
  content->replace(place, std::string_view(broken.from).size(), broken.to);
  try {
    format.read(files);
    FAIL() << "was read";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().file, broken.file) << error.what();
    EXPECT_THAT(error.what(), HasSubstr(broken.problem));
    EXPECT_FALSE(error.remedy().empty());
  }
}

constexpr const char* kRotaryGridFile = "rotary_compensation_grid_table.csv";
constexpr const char* kRotaryOwnFile = "rotary_axis_corrections.csv";

INSTANTIATE_TEST_SUITE_P(
    All, DamagedRotaryTables,
    ::testing::Values(
        DamagedRotary{"neutral-csv", kRotaryGridFile, "# body = table", "# body = cradle",
                      "body is \"cradle\""},
        DamagedRotary{"neutral-csv", kRotaryGridFile, "# body = table", "# body = tool", "the other body"},
        DamagedRotary{"neutral-csv", kRotaryGridFile, "# content = compensation", "# content = error",
                      "content is"},
        DamagedRotary{"neutral-csv", kRotaryGridFile, "# axes = A C\n", "", "axes = ... is missing"},
        DamagedRotary{"neutral-csv", kRotaryGridFile, "# axes = A C", "# axes = C A", "axes is \"C A\""},
        DamagedRotary{"neutral-csv", kRotaryGridFile, "# axes = A C", "# axes = A X", "axes is \"A X\""},
        DamagedRotary{"neutral-csv", kRotaryGridFile, "modulo 360 deg", "modulo 180 deg", "beyond_ends.C"},
        DamagedRotary{"neutral-csv", kRotaryGridFile, "mm = 10 -20 0", "mm = 10 -20", "reference_point_mm"},
        DamagedRotary{"neutral-csv", kRotaryGridFile, "a_deg,c_deg", "a_deg,b_deg", "the header is"},
        DamagedRotary{"neutral-csv", kRotaryGridFile, "\n-110,-170,", "\n-110,-171,", "not a complete grid"},
        DamagedRotary{"neutral-csv", kRotaryGridFile, "\n-110,-170,", "\n-110,nan,", "not a number"},
        DamagedRotary{"neutral-csv", kRotaryOwnFile, "\nC,-170,", "\nX,-170,", "axis is \"X\""},
        DamagedRotary{"neutral-csv", kRotaryOwnFile, "\nC,-170,", "\nC,-190,", "does not lie beyond"},
        DamagedRotary{"neutral-csv", kRotaryOwnFile, "axis,position_deg", "axis,position_mm",
                      "the header is"},
        DamagedRotary{"csv", "rotary_error_grid_table.csv", "# body = table", "# body = tool",
                      "the other body"},
        DamagedRotary{"csv", "metadata.csv", "compensation_type,L-VOL+R-VOL", "compensation_type,L-VOL+R-VAL",
                      "compensation_type is"},
        DamagedRotary{"isg-csv", "volcomp.lis", "chain CAXYZ", "chain CAXYX", "chain is \"CAXYX\""},
        DamagedRotary{"isg-csv", "volcomp.lis", "chain CAXYZ\n", "", "workpiece_axes is"},
        DamagedRotary{"isg-csv", "volcomp.lis", "workpiece_axes 2", "workpiece_axes x", "workpiece_axes is"},
        DamagedRotary{"isg-csv", "volcomp.csv", "// workpiece side", "// side", "does not say whose errors"},
        DamagedRotary{"isg-csv", "volcomp.csv", "PXA PYA PZA", "PXA PYA PZB", "column PZB is not read"},
        DamagedRotary{"isg-csv", "volcomp.csv", "C EXC EYC", "C EXC EXC", "column EXC is not read"},
        DamagedRotary{"isg-csv", "volcomp.csv", "A EXA EYA", "A EXA EYC", "column EYC is not read"},
        DamagedRotary{"isg-csv", "volcomp.csv", "\n10.000000 ", "\n355.000000 ", "does not lie beyond"},
        DamagedRotary{"isg-csv", "volcomp.csv", "\n10.000000 ", "\n10.000000 1 ", "the row has 8 numbers"},
        DamagedRotary{"linuxcnc-grid", "volcal.rotary", "volcal-rotary-1 inch", "volcal-rotary-1 m",
                      "neither mm"},
        DamagedRotary{"linuxcnc-grid", "volcal.rotary", "chain C' A' b X Y Z", "chain X C' A' b Y Z",
                      "volcal.rotary"},
        DamagedRotary{"linuxcnc-grid", "volcal.rotary", "own A", "own X", "no rotary axis of the chain"},
        DamagedRotary{"linuxcnc-grid", "volcal.rotary", "own C 37 1", "own C 36 1", "do not make a turn"},
        DamagedRotary{"linuxcnc-grid", "volcal.rotary", "twists table", "twists tool",
                      "turns the other body"},
        DamagedRotary{"linuxcnc-grid", "volcal.rotary", "A 23 0 C 37 1", "A 23 0 C 38 1", "volcal.rotary"},
        DamagedRotary{"heidenhain", "C.COM.txt", "AXISPOS C", "AXISPOS X", "a column is named \"X\""},
        DamagedRotary{"heidenhain", "C.COM.txt", "\n10.0000 ", "\n-10.0000 ", "does not lie beyond"},
        DamagedRotary{"fanuc", "pitch_error.txt", "3625 C 360", "3625 C 350",
                      "not a turn from the reference"},
        DamagedRotary{"fanuc", "pitch_error.txt", "3625 C 360", "3625 X 360", "is not read here"},
        DamagedRotary{"fanuc", "pitch_error.txt", "DETECTION_UNIT_DEG 0.001\n", "", "DETECTION_UNIT_DEG"},
        DamagedRotary{"sinumerik", "AX_EEC.INI", "IS_MODULO[0,C1]=1", "IS_MODULO[0,C1]=2",
                      "is not read here"},
        DamagedRotary{"sinumerik", "AX_EEC.INI", "IS_MODULO[0,A1]=0", "IS_MODULO[0,A1]=1",
                      "not a turn that ends as it begins"},
        DamagedRotary{"sinumerik", "AX_EEC.INI", "[0,C1]=360.000000", "[0,C1]=350.000000", "do not reach"},
        DamagedRotary{"sinumerik", "AX_EEC.INI", "[0,0,C1]", "[0,0,U1]", "the machine axis is \"U1\""}));

/// Whatever is cut off or overwritten, a reader answers with an error of input or reads.
TEST(RotaryTableReaders, NothingElseThanAnInputErrorComesOfThem) {
  const FitResult result = rotary_result(testing::kTrunnion);
  for (const char* name :
       {"csv", "neutral-csv", "sinumerik", "isg-csv", "linuxcnc-grid", "heidenhain", "fanuc"}) {
    const TableFormat& format = *find_table_format(name);
    const auto whole =
        rotary_files(name, result, rotary_options(default_type(format, result).name().c_str(), 90.0));
    int refused = 0;
    for (std::size_t which = 0; which < whole.size(); ++which) {
      if (!whole[which].name.starts_with("rotary") && std::string_view(name).ends_with("csv") &&
          std::string_view(name) != "isg-csv")
        continue;
      auto files = whole;
      std::string& content = files[which].content;
      const std::string original = content;
      for (std::size_t at = 0; at < original.size(); at += 13) {
        for (const bool cut : {true, false}) {
          content = cut ? original.substr(0, at) : original;
          if (!cut) content[at] = 'x';
          try {
            format.read(files);
          } catch (const InputError& error) {
            ++refused;
            EXPECT_FALSE(error.place().file.empty()) << error.what();
            EXPECT_FALSE(error.remedy().empty()) << error.what();
          }
        }
      }
    }
    EXPECT_GT(refused, 10) << name;
  }
}

}  // namespace
}  // namespace volcal
