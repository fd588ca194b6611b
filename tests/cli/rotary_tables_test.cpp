/// Errors of rotary axes as a user gets them: at a point by hand, in tables, with what they leave.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/scratch_folder.h"

namespace volcal {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;
using testing::run_program;

/// `axes`: the letters of the structure; reference points and centres at 0; one tool.
std::string machine_text(const std::string& structure, const std::string& axes, const std::string& tool) {
  std::string text = "format = \"volcal-machine-1\"\nname = \"by hand\"\nstructure = \"" + structure +
                     "\"\n[datum]\nprimary = \"X\"\nsecondary = \"Y\"\n";
  for (const char axis : axes) {
    text += std::string("[axes.") + axis + "]\n";
    text += std::string("ABC").find(axis) == std::string::npos
                ? "travel_mm = [-500.0, 500.0]\nhome_mm = 0.0\nreference_point_mm = [0.0, 0.0, 0.0]\n"
                : "travel_deg = [-180.0, 180.0]\nhome_deg = 0.0\ncentre_mm = [0.0, 0.0, 0.0]\n";
  }
  return text + "[tools.t]\noffset_mm = " + tool + "\n";
}

void write_text(const std::filesystem::path& path, const std::string& text) { std::ofstream(path) << text; }

bool is_location(const std::string& symbol) { return symbol.size() == 4; }

/// 10 um or 100 urad of one error: an error motion as a constant.
std::string model_text(const std::string& symbol) {
  const bool angle = std::string("ABC").find(symbol[1]) != std::string::npos;
  const std::string unit = angle ? "urad" : "um", value = angle ? "100.0" : "10.0";
  std::string text =
      "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n[functions]\n"
      "default = { basis = \"zero\" }\n";
  if (is_location(symbol)) return text + "[locations]\n" + symbol + "_" + unit + " = " + value + "\n";
  return text + symbol + " = { basis = \"bspline\", degree = 1, knots_deg = [-180, 180], coefficients_" +
         unit + " = [" + value + ", " + value + "] }\n";
}

struct HandWorked {
  const char* structure;
  const char* axes;
  const char* tool;
  const char* at;
  std::map<std::string, std::vector<double>> um;  ///< by error
};

/// Functional-point errors of hand_worked_test.cpp, all rows.
const std::vector<HandWorked>& hand_worked() {
  static const std::vector<HandWorked> all = {{"w C' b X Y Z t",
                                               "XYZC",
                                               "[0.0, 0.0, 0.0]",
                                               "C=90,X=100,Z=50",
                                               {{"EXC", {0, 10, 0}},
                                                {"EYC", {-10, 0, 0}},
                                                {"EZC", {0, 0, 10}},
                                                {"EAC", {5, 0, 0}},
                                                {"EBC", {0, 5, -10}},
                                                {"ECC", {-10, 0, 0}},
                                                {"EX0C", {0, -10, 0}},
                                                {"EY0C", {10, 0, 0}},
                                                {"EA0C", {-5, 0, 0}},
                                                {"EB0C", {0, -5, 10}},
                                                {"EC0C", {-10, 0, 0}}}},
                                              {"w b X Y Z C t",
                                               "XYZC",
                                               "[100.0, 0.0, -200.0]",
                                               "C=90",
                                               {{"EXC", {10, 0, 0}},
                                                {"EAC", {0, 20, 10}},
                                                {"EBC", {-20, 0, 0}},
                                                {"ECC", {-10, 0, 0}},
                                                {"EX0C", {10, 0, 0}},
                                                {"EA0C", {0, 20, 10}}}},
                                              {"w C' A' b X Y Z t",
                                               "XYZAC",
                                               "[0.0, 0.0, 0.0]",
                                               "A=-90,X=100,Z=50",
                                               {{"EZC", {0, 0, 10}},
                                                {"EBC", {0, 0, -10}},
                                                {"ECC", {-5, 10, 0}},
                                                {"EYA", {0, 0, -10}},
                                                {"EBA", {5, -10, 0}}}},
                                              {"w X' b Y Z C B t",
                                               "XYZBC",
                                               "[0.0, 0.0, -200.0]",
                                               "C=90,B=90",
                                               {{"EAC", {0, 0, -20}},
                                                {"EBC", {0, 0, 0}},
                                                {"ECC", {20, 0, 0}},
                                                {"EXB", {0, 10, 0}},
                                                {"EAB", {0, 0, 0}},
                                                {"EBB", {0, 0, 20}},
                                                {"ECB", {20, 0, 0}}}}};
  return all;
}

/// The pose turns A or C in every row; an axis without stated errors stands in the model with one of 0.
TEST(RotaryErrorsAtAPoint, AreThoseWorkedByHand) {
  for (const HandWorked& machine : hand_worked()) {
    const testing::ScratchFolder folder;
    write_text(folder.path() / "machine.toml", machine_text(machine.structure, machine.axes, machine.tool));
    for (const auto& [symbol, expected] : machine.um) {
      std::string model = model_text(symbol);
      const bool has_locations = is_location(symbol);
      if (!has_locations) model += "[locations]\n";
      for (const char axis : std::string("ABC")) {
        const std::string zero = std::string(axis == 'A' ? "EB0" : "EA0") + axis;
        if (std::string(machine.axes).find(axis) != std::string::npos && zero != symbol)
          model += zero + "_urad = 0.0\n";
      }
      write_text(folder.path() / "model.toml", model);
      const auto run = run_program("tables " + (folder.path() / "model.toml").string() + " --at " +
                                   machine.at + " --json");
      ASSERT_EQ(run.exit_code, 0) << run.errors << model;
      const Json error = Json::parse(run.output).at("volumetric_errors").at(0).at("error_um");
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(error.at(k).get<double>(), expected[k], 1e-6) << machine.structure << " " << symbol;
    }
  }
}

std::string five_axis_model() {
  return "format = \"volcal-model-1\"\nmachine = \"machine.toml\"\n[functions]\ndefault = { basis = \"zero\" "
         "}\n"
         "EXX = { basis = \"legendre\", degree = 2, coefficients_um = [0.0, 9.0, 0.0] }\n"
         "ECC = { basis = \"fourier\", degree = 1, coefficients_urad = [0.0, 12.0, 5.0] }\n"
         "EAC = { basis = \"fourier\", degree = 1, coefficients_urad = [0.0, 8.0, -6.0] }\n"
         "[locations]\nEX0C_um = 12.0\nEA0C_urad = 30.0\nEY0A_um = -9.0\nEB0A_urad = 25.0\n";
}

struct FiveAxisFolder {
  testing::ScratchFolder folder;
  std::string model;

  FiveAxisFolder() {
    write_text(folder.path() / "machine.toml",
               machine_text("w C' A' b X Y Z t", "XYZAC", "[0.0, 0.0, -200.0]"));
    write_text(folder.path() / "model.toml", five_axis_model());
    model = (folder.path() / "model.toml").string();
  }
  std::string out(const char* name) const { return (folder.path() / name).string(); }
};

TEST(RotaryTablesProgram, WritesErrorsOfRotaryAxesAndSaysWhatTheyLeave) {
  const FiveAxisFolder given;
  const auto run = run_program("tables " + given.model + " --format csv -o " + given.out("csv"));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("csv L-VOL+R-VOL, tool t"));
  EXPECT_THAT(run.output, HasSubstr("Errors of rotary axes left at 400 poses of all axes"));
  EXPECT_THAT(run.output, ::testing::Not(HasSubstr("are in none of the tables")));
  EXPECT_THAT(run.output, HasSubstr("rotary_error_grid_table.csv"));
  const std::string errors = testing::content(std::filesystem::path(given.out("csv")) / "error_tables.csv");
  EXPECT_THAT(errors, HasSubstr("\nECC,C,-180,deg,0,"));
  EXPECT_THAT(errors, HasSubstr("\nEX0C,,,,0,12,um,"));
  // The folder is known errors in its turn: the same error at a pose but for linear interpolation.
  const std::string at = " --at A=-40,C=70,X=100,Z=300 --json";
  const auto error_of = [&](const std::string& source) {
    const auto at_point = run_program("tables " + source + at);
    EXPECT_EQ(at_point.exit_code, 0) << at_point.errors;
    return Json::parse(at_point.output)
        .at("volumetric_errors")
        .at(0)
        .at("error_um")
        .get<std::vector<double>>();
  };
  const auto of_model = error_of(given.model), of_tables = error_of(given.out("csv"));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(of_tables[k], of_model[k], 0.05);
}

TEST(RotaryTablesProgram, JsonHasTheFiguresAndTheMovesOfRotaryAxes) {
  const FiveAxisFolder given;
  const auto run = run_program("tables " + given.model +
                               " --format neutral-csv --type R-VOL --dry-run --at A=-40,C=90,Z=200 --json");
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const Json json = Json::parse(run.output);
  EXPECT_EQ(json.at("type"), "R-VOL");
  const Json left = json.at("rotary_error_left");
  EXPECT_GT(left.at("before").at("rms_um"), 10.0);
  EXPECT_LT(left.at("ideal").at("rms_um"), 0.01);
  EXPECT_LT(left.at("tables").at("rms_um"), 0.2);
  EXPECT_TRUE(json.at("corrections").at(0).contains("rotary_correction_urad"));
  EXPECT_EQ(json.at("corrections").at(0).at("position").at("A"), -40.0);
}

TEST(RotaryTablesProgram, OwnPositioningAloneIsSaidToBeAPart) {
  const FiveAxisFolder given;
  const auto run = run_program("tables " + given.model + " --format sinumerik --rotary-step 10 -o " +
                               given.out("siemens"));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("the tables hold only R-POS of the errors of axis C"));
  const std::string file = testing::content(std::filesystem::path(given.out("siemens")) / "AX_EEC.INI");
  EXPECT_THAT(file, HasSubstr("$AA_ENC_COMP_STEP[0,C1]=10.000000\n"));
  EXPECT_THAT(file, HasSubstr("$AA_ENC_COMP_IS_MODULO[0,C1]=1\n"));
  const auto refused = run_program("tables " + given.model + " --format linuxcnc --type L-POS+FOR --dry-run");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.errors, HasSubstr("which no table holds"));
}

/// A browser that leaves the page it was given as the picture, and beside it what a PNG begins with.
std::string path_of_a_browser(const FiveAxisFolder& given) {
  const std::filesystem::path folder = given.folder.path() / "bin";
  std::filesystem::create_directory(folder);
  write_text(folder / "chromium",
             "#!/bin/sh\nfor word; do case \"$word\" in\n--screenshot=*) out=\"${word#--screenshot=}\";;\n"
             "file://*) page=\"${word#file://}\";;\nesac; done\ncp \"$page\" \"$out\"\n");
  std::filesystem::permissions(folder / "chromium", std::filesystem::perms::owner_all);
  return "env PATH=" + folder.string() + ":$PATH";
}

/// Whether the program has the page that pictures are drawn from.
bool has_pictures(const testing::ProgramRun& run) {
  return run.errors.find("which this program lacks") == std::string::npos;
}

TEST(RotaryTablesProgram, PicturesWhatTheTablesAddAndLeave) {
  const FiveAxisFolder given;
  const auto run =
      testing::run_with(path_of_a_browser(given), "tables " + given.model +
                                                      " --format neutral-csv --type R-VOL --dry-run"
                                                      " --picture " +
                                                      given.out("tables.png"));
  if (!has_pictures(run)) GTEST_SKIP() << "built without the report";
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  const std::string page = testing::content(given.out("tables.png"));
  EXPECT_THAT(page, ::testing::StartsWith("<!DOCTYPE html>"));
  const std::string mark = "id=\"volcal-data\">";
  const std::size_t data = page.find(mark) + mark.size();
  const Json drawn = Json::parse(page.substr(data, page.find("</script>", data) - data)).at("pages").at(0);
  EXPECT_EQ(drawn.at("kind"), "rotary_tables");
  EXPECT_EQ(drawn.at("data").at("type"), "R-VOL");
  const Json of_c = drawn.at("data").at("axes").at(1);
  ASSERT_EQ(of_c.at("axis"), "C");
  const auto positions = of_c.at("position").get<std::vector<double>>();
  const auto turned = of_c.at("turned").get<std::vector<double>>();
  ASSERT_EQ(positions.size(), turned.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double c = positions[i] * std::acos(-1.0) / 180.0;
    EXPECT_NEAR(turned[i], -12.0 * std::cos(c) - 5.0 * std::sin(c), 0.1) << "against ECC at " << positions[i];
  }
  EXPECT_FALSE(std::filesystem::exists(given.out("tables.png.part")));
}

TEST(RotaryTablesProgram, RefusesPicturesOfNothing) {
  const FiveAxisFolder given;
  const auto refused = [&](const std::string& options, const std::string& words) {
    const auto run = testing::run_with(path_of_a_browser(given), "tables " + given.model + " " + options);
    if (!has_pictures(run)) return;
    EXPECT_EQ(run.exit_code, 2) << options;
    EXPECT_THAT(run.errors, HasSubstr(words)) << options;
    EXPECT_FALSE(std::filesystem::exists(given.out("tables.png"))) << options;
  };
  const std::string picture = " --picture " + given.out("tables.png");
  refused("--type L-VOL --dry-run" + picture,
          "L-VOL has no tables of rotary axes, and the picture shows those");
  refused("--at X=0" + picture, "--picture needs tables, and none are made (give -o FOLDER or --dry-run)");
  refused("--dry-run --picture " + given.out("tables.svg"), "--picture takes the name of a PNG file");
  refused("--dry-run --picture " + given.out("none/tables.png"), "its folder does not exist");
  write_text(given.folder.path() / "bin" / "chromium", "#!/bin/sh\nexit 1\n");
  const auto silent = testing::run_with("env PATH=" + given.out("bin") + ":$PATH",
                                        "tables " + given.model + " --dry-run" + picture);
  EXPECT_EQ(silent.exit_code, 2);
  EXPECT_THAT(silent.errors,
              ::testing::AnyOf(HasSubstr("drew no picture"), HasSubstr("which this program lacks")));
}

/// Where the linear axes have no errors, those of rotary axes and what is entered against them depend on
/// where the tool is, not on whether Z or the quill W brought it there.
TEST(RotaryTablesProgram, HoldsBesideAParallelAxis) {
  const FiveAxisFolder given;
  const auto without_errors_of_x = [] {
    std::string text = five_axis_model();
    const std::size_t x = text.find("EXX"), next = text.find("ECC");
    return text.substr(0, x) + text.substr(next);
  };
  write_text(given.folder.path() / "machine.toml",
             machine_text("w C' A' b X Y Z W t", "XYZWAC", "[0.0, 0.0, -200.0]"));
  write_text(given.folder.path() / "model.toml", without_errors_of_x());
  const auto at = [&](const std::string& place) {
    const auto run =
        run_program("tables " + given.model + " --dry-run --json --at A=-40,C=90,X=70,Y=-20," + place);
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return Json::parse(run.output);
  };
  const Json by_z = at("Z=-200,W=0"), by_w = at("Z=0,W=-200"), home = at("Z=0,W=0");
  EXPECT_EQ(by_z.at("type"), "L-VOL+R-VOL");
  for (const char* figure : {"correction_um", "rotary_correction_urad"})
    EXPECT_EQ(by_z.at("corrections").at(0).at(figure), by_w.at("corrections").at(0).at(figure)) << figure;
  EXPECT_NE(by_z.at("corrections").at(0).at("correction_um"),
            home.at("corrections").at(0).at("correction_um"));
  EXPECT_LT(by_w.at("rotary_error_left").at("tables").at("rms_um"), 0.2);
}

/// FOR turns rotary axes by what all axes do: no table holds it, and programs are not rewritten beside W.
TEST(RotaryTablesProgram, RefusesForBesideAParallelAxis) {
  const FiveAxisFolder given;
  write_text(given.folder.path() / "machine.toml",
             machine_text("w C' A' b X Y Z W t", "XYZWAC", "[0.0, 0.0, -200.0]"));
  write_text(given.folder.path() / "part.ngc", "G21 G90 G54\nG43.4 H1\nG0 X0 Y0 Z0\n");
  for (const char* type : {"R-VOL+FOR", "R-VOL+", "L-VOL+FOR"}) {
    const auto run = run_program("tables " + given.model + " --dry-run --type " + type);
    EXPECT_EQ(run.exit_code, 2) << type;
    EXPECT_THAT(run.errors, HasSubstr("FOR moves rotary axes by what all axes do, which no table holds"))
        << type;
    EXPECT_THAT(run.errors, HasSubstr("it can do L-VOL+R-VOL")) << type;
  }
  const auto program = run_program("compensate " + given.model + " " + given.out("part.ngc") +
                                   " --orientation --check --work-offset G54=X0,Y0,Z0 --tool-length H1=200");
  EXPECT_EQ(program.exit_code, 2);
  EXPECT_THAT(program.errors, HasSubstr("the compensation of programs cannot take the parallel axis W"));
}

/// A program with tool centre point motion, rewritten for the same machine.
TEST(RotaryTablesProgram, RewritesAProgramWithToolCentrePointMotion) {
  const FiveAxisFolder given;
  write_text(given.folder.path() / "part.ngc",
             "G21 G90 G54\nG0 A-10 C0\nG43.4 H1\nG0 X40 Y10 Z30 A-10 C0\nG1 X60 Y20 Z25 A-30 C40 F800\n"
             "X20 Y50 A10 C120\nG49\nM30\n");
  const std::string program = "compensate " + given.model + " " + given.out("part.ngc") + " --check" +
                              " --work-offset G54=X0,Y0,Z0 --tool-length H1=200";
  const auto run = run_program(program + " -o " + given.out("new.ngc"));
  ASSERT_EQ(run.exit_code, 0) << run.errors;
  EXPECT_THAT(run.output, HasSubstr("3 motions with tool centre point motion"));
  EXPECT_THAT(run.output, HasSubstr("1 rapids outside it are copied as they are"));
  EXPECT_THAT(run.output, ::testing::Not(HasSubstr("are in none of the tables")));
  const std::string text = testing::content(given.out("new.ngc"));
  EXPECT_THAT(text, ::testing::StartsWith("(volcal compensate: result "));
  EXPECT_THAT(text, HasSubstr("\nG0 A-10 C0\nG43.4 H1\n"));
  const auto figures = run_program(program + " --json --orientation");
  ASSERT_EQ(figures.exit_code, 0) << figures.errors;
  const Json json = Json::parse(figures.output);
  EXPECT_GT(json.at("check").at("before").at("rms_um"), 5.0);
  EXPECT_LT(json.at("check").at("after").at("rms_um"), 0.3);
  EXPECT_LT(json.at("check").at("after").at("axis_rms_urad").get<double>(),
            0.5 * json.at("check").at("before").at("axis_rms_urad").get<double>());
  EXPECT_GT(json.at("positions_near_poles"), 0);
  const auto twice = run_program("compensate " + given.model + " " + given.out("new.ngc") + " --check" +
                                 " --work-offset G54=X0,Y0,Z0 --tool-length H1=200");
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.errors, HasSubstr("compensated already"));
  write_text(given.folder.path() / "three.ngc", "G21 G90 G54\nG0 X0 Y0 Z0\n");
  const auto plain = run_program("compensate " + given.model + " " + given.out("three.ngc") +
                                 " --check --orientation --work-offset G54=X0,Y0,Z0");
  EXPECT_EQ(plain.exit_code, 2);
  EXPECT_THAT(plain.errors, HasSubstr("no tool centre point motion"));
}

/// The tables that a rehearsal's control had active are those of rotary axes, too.
TEST(RotaryTablesProgram, AreAppliedByASimulatedMachine) {
  const FiveAxisFolder given;
  ASSERT_EQ(
      run_program("tables " + given.model + " --format linuxcnc-grid --step 200 -o " + given.out("tables"))
          .exit_code,
      0);
  write_text(given.folder.path() / "study.toml",
             "format = \"volcal-study-1\"\nmachine = \"machine.toml\"\nseed = 3\n[[measurements]]\n"
             "kind = \"r-test\"\ntools = [\"t\"]\npositions = { A = 5, C = 6 }\nposes = \"grid\"\n"
             "noise = { constant_um = 0.01, repeatability_um = 0.01 }\n[[measurements.spheres]]\n"
             "name = \"S\"\nposition_mm = [60.0, 20.0, 0.0]\n");
  const auto spread_um = [&](const std::string& options, const char* name) {
    const auto run = run_program("simulate " + given.out("study.toml") + " --errors " + given.model + " -o " +
                                 given.out(name) + options);
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    std::istringstream rows(testing::content(std::filesystem::path(given.out(name)) / "rtest_S_t.csv"));
    std::string line;
    std::getline(rows, line);
    std::vector<std::array<double, 3>> readings;
    while (std::getline(rows, line)) {
      std::vector<std::string> cells;
      std::istringstream row(line);
      for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
      const std::size_t n = cells.size();
      readings.push_back(
          {std::stod(cells.at(n - 3)), std::stod(cells.at(n - 2)), std::stod(cells.at(n - 1))});
    }
    EXPECT_GT(readings.size(), 20U);
    std::array<double, 3> mean{};
    for (const auto& reading : readings)
      for (std::size_t k = 0; k < 3; ++k) mean[k] += reading[k] / static_cast<double>(readings.size());
    double square = 0.0;
    for (const auto& reading : readings)
      for (std::size_t k = 0; k < 3; ++k) square += std::pow(reading[k] - mean[k], 2);
    return std::sqrt(square / static_cast<double>(readings.size()));
  };
  EXPECT_GT(spread_um("", "before"), 5.0);
  EXPECT_LT(spread_um(" --compensation " + given.out("tables"), "after"), 0.4);
}

}  // namespace
}  // namespace volcal
