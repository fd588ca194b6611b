/// Tables of unknown layout, and point lists of trackers.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/import_files.h"
#include "tests/support/refusal.h"
#include "volcal/identify/io/import/column_meaning.h"
#include "volcal/identify/io/import/table_layout.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::import_machine;
using ::testing::IsEmpty;
using testing::refusal;
using testing::replaced;
using testing::SampleImport;

class TablesAndPoints : public ::testing::Test {
 protected:
  ImportedReadings import(const std::string& text, ImportAnswers answers, const char* format = "csv",
                          const std::string& nominal = testing::kNominalPoints) const {
    answers.nominal = {"nominal.csv", nominal};
    const ImportSource source{"t.txt", text};
    return import_format_of(source, format).read(source, answers, import_machine(), 0);
  }
  static std::string key(const ImportedReadings& readings, const std::string& name) {
    const auto found = readings.keys.find(name);
    return found == readings.keys.end() ? "" : found->second;
  }
  static ImportedReadings import_at(const Machine& machine, const std::string& text,
                                    const std::map<AxisName, double>& at) {
    ImportAnswers answers;
    answers.instrument = "displacement";
    answers.at = at;
    const ImportSource source{"t.txt", text};
    return import_format_of(source, "csv").read(source, answers, machine, 0);
  }
  std::string refused(const std::string& text, const ImportAnswers& answers, const char* format = "csv",
                      const std::string& nominal = testing::kNominalPoints) const {
    return refusal([&] { import(text, answers, format, nominal); });
  }
  static const std::vector<double>& column(const ImportedReadings& readings, const std::string& name) {
    for (const ImportedColumn& one : readings.columns) {
      if (one.name == name) return one.values;
    }
    throw std::runtime_error("no column " + name);
  }
  static std::string fact(const ImportedReadings& readings, const std::string& what) {
    for (const ImportFact& one : readings.facts) {
      if (one.what == what) return one.value + " <" + one.said_by + ">";
    }
    return "";
  }
  static const SampleImport& sample(const std::vector<SampleImport>& all, const std::string& name) {
    for (const SampleImport& one : all) {
      if (one.name == name) return one;
    }
    throw std::runtime_error("no sample " + name);
  }

  std::vector<SampleImport> tables_ = testing::sample_tables(), lists_ = testing::sample_point_lists();
};

TEST_F(TablesAndPoints, LayoutOfTables) {
  struct Case {
    std::string text;
    char delimiter, decimal;
    int header_line;
    std::vector<std::string> first;
  };
  const std::vector<Case> cases = {
      {"a;b\n0,5;1,25\n1,5;2\n", ';', ',', 1, {"0,5", "1,25"}},
      {"a,b\n0.5,1.25\n", ',', '.', 1, {"0.5", "1.25"}},
      {"a\tb\n0,5\t1,25\n", '\t', ',', 1, {"0,5", "1,25"}},
      {"head line\n\nname x y\nP1 1,5 2,5\nP2 2,5 3,5\n", ' ', ',', 3, {"P1", "1,5", "2,5"}},
      {"a;b\r\n[mm];[um]\r\n1;2\r\n", ';', '.', 1, {"1", "2"}},
      {"# a | b\n1|2\n", '|', '.', 1, {"1", "2"}},
      {"\"a;b\";c\n1;2\n", ';', '.', 1, {"1", "2"}},
      {"P1 1 2 3\nP2 4 5 6\n", ' ', '.', 0, {"P1", "1", "2", "3"}}};
  for (const Case& one : cases) {
    const TableLayout layout = guess_table_layout({"t.csv", one.text});
    EXPECT_EQ(layout.delimiter, one.delimiter) << one.text;
    EXPECT_EQ(layout.decimal, one.decimal) << one.text;
    EXPECT_EQ(layout.header_line, one.header_line) << one.text;
    EXPECT_EQ(layout.rows.at(0).cells, one.first) << one.text;
  }
  EXPECT_THAT(guess_table_layout({"t.csv", "a;b\n[mm];[um]\n1;2\n"}).header, ElementsAre("a [mm]", "b [um]"));
}

TEST_F(TablesAndPoints, DamagedTablesAreRefusedWithTheLine) {
  const auto layout = [](const std::string& text) {
    return refusal([&] { guess_table_layout({"t.csv", text}); });
  };
  EXPECT_THAT(layout("a;b;c\n1;2;3\n4;5\n6;7;8\n"),
              HasSubstr("t.csv:3: the row has 2 cells, the rows above 3"));
  EXPECT_THAT(layout("a;b\n1;2\n3;x\n5;6\n"), HasSubstr("t.csv:3: column \"b\" holds \"x\", not a number"));
  EXPECT_THAT(layout("a;b\n1;2\n3;\n5;6\n"), HasSubstr("t.csv:3: column \"b\" holds \"\""));
  EXPECT_THAT(layout("a;b\n1;2,5\n3;1.234,5\n5;6\n"), HasSubstr("t.csv:3:")) << "a separator of thousands";
  EXPECT_THAT(layout("a;b\n1;2,5\n3;1.5\n5;6\n"), HasSubstr("t.csv:3: decimal commas and decimal points"));
  EXPECT_THAT(layout("only\nwords\n"), HasSubstr("t.csv:1: no table of numbers"));
}

TEST_F(TablesAndPoints, MeaningOfColumns) {
  const SampleImport& german = sample(tables_, "semicolon.csv");
  const ImportedReadings readings = import(german.bytes, german.answers);
  EXPECT_THAT(column(readings, "x_mm"), ElementsAre(0.0, 100.0, 200.0));
  EXPECT_THAT(column(readings, "deviation_um"), ElementsAre(-1.5, 2.25, 3.0));
  EXPECT_TRUE(readings.guessed);
  EXPECT_EQ(fact(readings, "delimiter"), "semicolon <guessed>");
  EXPECT_EQ(fact(readings, "decimal sign"), "comma <guessed>");
  EXPECT_EQ(fact(readings, "column \"Abweichung [\u00B5m]\""), "deviation_um, in \u00B5m <guessed>");
  const SampleImport& units = sample(tables_, "units-row.csv");
  const ImportedReadings nanometres = import(units.bytes, units.answers);
  EXPECT_THAT(column(nanometres, "deviation_um"), ElementsAre(1.5, 2.5, -0.5));
  EXPECT_THAT(column(nanometres, "time_s"), ElementsAre(0.0, 60.0, 120.0));
  const SampleImport& standard = sample(tables_, "standard.csv");
  EXPECT_FALSE(import(standard.bytes, standard.answers).guessed);
  const SampleImport& tabs = sample(tables_, "tabs.csv");
  const ImportedReadings report = import(tabs.bytes, tabs.answers);
  EXPECT_NEAR(column(report, "deviation_um")[2], 3.0, 1e-12);
  EXPECT_THAT(fact(report, "column \"comment\""), HasSubstr("not read"));
  EXPECT_EQ(fact(report, "beside the table"), "1 line, first \"report of a test\" <not read>");
}

TEST_F(TablesAndPoints, TemperaturesAreNoTimes) {
  ImportAnswers answers = sample(tables_, "standard.csv").answers;
  const std::string rows = "0,1,0,20,+\n100,2,1,20.5,+\n200,-1,2,21,-\n";
  for (const char* header :
       {"T air [\u00B0C]", "T_air_degC", "Temp air (C)", "t air [degC]", "Air [\u00B0C]"}) {
    const ImportedReadings readings = import(
        "Position X [mm],Error [um],Time [min]," + std::string(header) + ",Direction\n" + rows, answers);
    EXPECT_THAT(column(readings, "time_s"), ElementsAre(0.0, 60.0, 120.0)) << header;
    EXPECT_THAT(column(readings, "T_air_degC"), ElementsAre(20.0, 20.5, 21.0)) << header;
  }
  EXPECT_THAT(
      refused("Position X [mm],Error [um],Time [min],T air [K],Direction\n" + rows, answers),
      HasSubstr("the unit \"K\" of column \"T air [K]\" is not the degree Celsius (give it in degC, and "
                "name it T_air_degC)"));
  const ImportedReadings time =
      import("Position X [mm],Error [um],T [s]\n0,1,0\n100,2,1\n200,-1,2\n", answers);
  EXPECT_THAT(column(time, "time_s"), ElementsAre(0.0, 1.0, 2.0));
}

TEST_F(TablesAndPoints, WhatATableDoesNotSayIsAskedFor) {
  ImportAnswers answers = sample(tables_, "standard.csv").answers;
  const std::string bytes = sample(tables_, "standard.csv").bytes;
  answers.instrument.reset();
  EXPECT_THAT(refused(bytes, answers), HasSubstr("--instrument NAME: displacement, straightness"));
  answers = sample(tables_, "standard.csv").answers;
  answers.at.clear();
  EXPECT_THAT(refused(bytes, answers), HasSubstr("--at Y=...,Z=..."));
  answers = sample(tables_, "units-row.csv").answers;
  answers.axis.reset();
  EXPECT_THAT(refused(sample(tables_, "units-row.csv").bytes, answers), HasSubstr("give --axis X"));
  EXPECT_THAT(refused("1,2\n3,4\n", answers), HasSubstr("t.txt:1: no header"));
  EXPECT_THAT(refused("X;Y;Z;colour\n1;2;3;4\n", {}),
              HasSubstr("t.txt:1: no column is understood as a reading"));
  EXPECT_THAT(refused("X [V];deviation_um\n1;2\n", answers), HasSubstr("t.txt:1: the unit \"V\""));
  EXPECT_THAT(refused("X;Position X;deviation_um\n1;2;3\n", answers), HasSubstr("t.txt:1:"));
}

/// Measured minus target, whichever end the list begins at; by --set, on a diagonal and of displacements the
/// direction is another's.
TEST_F(TablesAndPoints, DeviationsAreReadAlongThePlusOfTheAxis) {
  const std::map<AxisName, double> at = {{AxisName::Y, 250.0}, {AxisName::Z, 150.0}};
  const std::string head = "X;deviation_um\n";
  for (const char* rows : {"0;0\n100;5\n200;10\n", "200;10\n100;5\n0;0\n", "200;10\n0;0\n200;10\n"}) {
    const ImportedReadings readings = import_at(import_machine(), head + rows, at);
    EXPECT_EQ(key(readings, "direction"), "[1, 0, 0]") << rows;
    EXPECT_EQ(fact(readings, "direction"), "along + of X <a deviation is measured minus target>");
  }
  ImportAnswers answers = sample(tables_, "standard.csv").answers;
  EXPECT_EQ(key(import(sample(tables_, "standard.csv").bytes, answers), "direction"), "") << "said by --set";
  EXPECT_EQ(
      key(import_at(import_machine(), "X;Y;deviation_um\n0;0;1\n9;9;2\n", {{AxisName::Z, 0.0}}), "direction"),
      "");
  EXPECT_EQ(key(import_at(import_machine(), "X;displacement_mm\n9;0\n0;-9\n", at), "direction"), "");
}

/// C = 90 deg turns the tool relative to the workpiece: p_w = Rz(90 deg) p, so that + X goes along + y.
TEST_F(TablesAndPoints, DirectionsAreThoseOfTheWorkpiece) {
  const Machine machine =
      parse_machine(testing::replaced(testing::kImportMachine, "w X' b Y Z t\"\n",
                                      "w C' b X Y Z t\"\n[axes.C]\ntravel_deg = [-180.0, 180.0]\nhome_deg = "
                                      "0.0\ncentre_mm = [0.0, 0.0, 0.0]\n"),
                    "machine.toml");
  const ImportedReadings readings = import_at(machine, "X;deviation_um\n200;2\n0;1\n",
                                              {{AxisName::Y, 0.0}, {AxisName::Z, 0.0}, {AxisName::C, 90.0}});
  EXPECT_EQ(key(readings, "direction"), "[0, 1, 0]");
}

TEST_F(TablesAndPoints, PositionsOfAnAxisThatMovesAreShifted) {
  std::map<AxisName, double> at = {{AxisName::X, 50.0}, {AxisName::Y, 250.0}, {AxisName::Z, 150.0}};
  const ImportedReadings readings = import_at(import_machine(), "X;deviation_um\n0;1\n100;2\n", at);
  EXPECT_THAT(column(readings, "x_mm"), ElementsAre(50.0, 150.0));
  EXPECT_EQ(fact(readings, "X"), "50 mm added to its positions <--at>");
  EXPECT_THAT(refusal([&] { import_at(import_machine(), "X;Y;deviation_um\n0;9;1\n100;9;2\n", at); }),
              HasSubstr("t.txt:2: the table says where Y stood, and so does --at (leave one of the two out"));
  ImportAnswers answers = sample(lists_, "cartesian.txt").answers;
  answers.at = {{AxisName::Z, 20.0}};
  const ImportedReadings points = import(sample(lists_, "cartesian.txt").bytes, answers, "tracker");
  EXPECT_THAT(column(points, "z_mm"), ElementsAre(20.0, 20.0, 20.0, 20.0, 120.0));
  EXPECT_EQ(fact(points, "Z"), "20 mm added to its positions <--at>");
}

TEST_F(TablesAndPoints, ParallelAxesAreKnown) {
  const Machine machine = parse_machine(
      testing::replaced(testing::kImportMachine, "w X' b Y Z t\"\n",
                        "w X' b Y Z W t\"\n[axes.W]\ntravel_mm = [0.0, 500.0]\nhome_mm = 0.0\n"),
      "machine.toml");
  const ImportedReadings readings = import_at(machine, "Position W [mm];deviation_um\n0;1\n100;2\n",
                                              {{AxisName::X, 1.0}, {AxisName::Y, 2.0}, {AxisName::Z, 3.0}});
  EXPECT_THAT(column(readings, "w_mm"), ElementsAre(0.0, 100.0));
  EXPECT_EQ(key(readings, "direction"), "[0, 0, 1]");
}

TEST_F(TablesAndPoints, AColumnOfAnAxisThatIsNotReadIsToBeConfirmed) {
  const ImportedReadings readings =
      import_at(import_machine(), "x_mm,state y,deviation_um\n0,on,1\n100,on,2\n",
                {{AxisName::Y, 2.0}, {AxisName::Z, 3.0}});
  EXPECT_TRUE(readings.guessed);
  EXPECT_EQ(fact(readings, "column \"state y\""), "not read: Y stands where --at says <guessed>");
}

TEST_F(TablesAndPoints, AnOpenDecimalSignIsAskedFor) {
  const auto first_row = [](const std::string& rows, std::optional<char> decimal) {
    const TableLayout layout = guess_table_layout({"t.csv", "a\tb\n" + rows, decimal});
    return std::vector<double>{layout.number(layout.rows.back(), 0), layout.number(layout.rows.back(), 1)};
  };
  const std::string open = "0\t1\n500\t2\n1,000\t3\n";
  EXPECT_THAT(
      refusal([&] { first_row(open, std::nullopt); }),
      HasSubstr("t.csv:4: \"1,000\" may be a number with three decimals or with a separator of "
                "thousands; every comma of the file stands so (give --decimal comma or --decimal point)"));
  EXPECT_THAT(first_row(open, '.'), ElementsAre(1000.0, 3.0));
  EXPECT_THAT(first_row(open, ','), ElementsAre(1.0, 3.0));
  EXPECT_THAT(first_row("0,000\t1\n1,000\t3\n", std::nullopt), ElementsAre(1.0, 3.0)) << "begins with 0,";
  EXPECT_THAT(first_row("1,000\t-0,125\n", std::nullopt), ElementsAre(1.0, -0.125));
  EXPECT_THAT(first_row("1,000\t2,5\n", std::nullopt), ElementsAre(1.0, 2.5));
  EXPECT_THAT(first_row("1000,125\t2\n", std::nullopt), ElementsAre(1000.125, 2.0)) << "four digits lead";
  EXPECT_THAT(first_row("1.234,5\t-1.234.567,25\n", ','), ElementsAre(1234.5, -1234567.25));
  EXPECT_THAT(refusal([&] { first_row("1\t2\n1,00\t3\n3\t4\n", '.'); }), HasSubstr("t.csv:3:"));
  EXPECT_THAT(refusal([&] { first_row("1\t2\n1.234,5\t3\n3\t4\n", std::nullopt); }),
              HasSubstr("t.csv:3: column \"a\" holds \"1.234,5\", not a number"));
}

TEST_F(TablesAndPoints, PolarListsGiveTheStation) {
  for (const char* name : {"gon.txt", "deg.txt"}) {
    const ImportedReadings readings =
        import(sample(lists_, name).bytes, sample(lists_, name).answers, "tracker");
    EXPECT_EQ(readings.instrument->traits.encoders.size(), 2U);
    // P1 from (-1000, 300, 50): 1000 along the machine's x, which is -y of the tracker, -300 along its x.
    EXPECT_NEAR(column(readings, "length_mm")[0], std::sqrt(1000.0 * 1000.0 + 300.0 * 300.0 + 50.0 * 50.0),
                1e-6);
    EXPECT_NEAR(std::remainder(column(readings, "azimuth_deg")[0] -
                                   std::atan2(-1000.0, -300.0) * 180.0 / std::numbers::pi,
                               360.0),
                0.0, 1e-7);
    EXPECT_NEAR(column(readings, "elevation_deg")[0],
                std::atan2(-50.0, std::hypot(1000.0, 300.0)) * 180.0 / std::numbers::pi, 1e-7);
    double x = 0.0, y = 0.0, z = 0.0;
    ASSERT_EQ(std::sscanf(readings.keys.at("station_mm").c_str(), "[%lf, %lf, %lf]", &x, &y, &z), 3);
    EXPECT_NEAR(x, -1000.0, 1e-4);
    EXPECT_NEAR(y, 300.0, 1e-4);
    EXPECT_NEAR(z, 50.0, 1e-4);
    EXPECT_THAT(column(readings, "x_mm"), ElementsAre(0, 200, 200, 0, 100));
  }
}

/// A square that is 10 um too large at each corner, along x and y: no rigid motion takes that away.
TEST_F(TablesAndPoints, CartesianListsGiveErrorVectors) {
  ImportAnswers answers = sample(lists_, "cartesian.txt").answers;
  const ImportedReadings readings = import(testing::cartesian_list(0.010), answers, "tracker");
  EXPECT_TRUE(readings.instrument->traits.reads_error_vectors);
  const std::vector<double> ex = {-10, 10, 10, -10, 0}, ey = {-10, -10, 10, 10, 0};
  for (std::size_t row = 0; row < 5; ++row) {
    EXPECT_NEAR(column(readings, "ex_um")[row], ex[row], 1e-3);
    EXPECT_NEAR(column(readings, "ey_um")[row], ey[row], 1e-3);
    EXPECT_NEAR(column(readings, "ez_um")[row], 0.0, 1e-3);
  }
  EXPECT_EQ(fact(readings, "unit of the lengths"), "mm <line 2>");
  EXPECT_THAT(column(readings, "dir_x"), ElementsAre(0, 0, 0, 0, 0));
}

TEST_F(TablesAndPoints, WhatAListDoesNotSayIsAskedFor) {
  const SampleImport& gon = sample(lists_, "gon.txt");
  const auto without = [&](auto change) {
    ImportAnswers answers = gon.answers;
    change(answers);
    return refused(gon.bytes, answers, "tracker");
  };
  EXPECT_THAT(without([](ImportAnswers& a) { a.horizontal.reset(); }),
              HasSubstr("--horizontal clockwise or counterclockwise"));
  EXPECT_THAT(without([](ImportAnswers& a) { a.vertical.reset(); }),
              HasSubstr("--vertical zenith or elevation"));
  EXPECT_THAT(without([](ImportAnswers& a) { a.horizontal = "counterclockwise"; }),
              HasSubstr("do not fit the commanded positions"));
  EXPECT_THAT(without([](ImportAnswers& a) { a.angle_unit = "deg"; }), HasSubstr("t.txt:"));
  EXPECT_THAT(refused(replaced(gon.bytes, "Hz [gon]", "Hz"), gon.answers, "tracker"),
              HasSubstr("--angle-unit gon, deg or rad"));
  EXPECT_THAT(refused(replaced(gon.bytes, "SD [m]", "SD"), gon.answers, "tracker"),
              HasSubstr("--unit mm, m or inch"));
  const std::string list = testing::cartesian_list(0.0);
  EXPECT_THAT(refused(list, {}, "tracker"), HasSubstr("--columns x,y,z or --columns hz,v,distance"));
  EXPECT_THAT(refused(replaced(list, "// Units: Millimeters", "//"), sample(lists_, "cartesian.txt").answers,
                      "tracker"),
              HasSubstr("--unit mm, m or inch"));
}

TEST_F(TablesAndPoints, DamagedListsAreRefusedWithTheLine) {
  const ImportAnswers answers = sample(lists_, "cartesian.txt").answers;
  const std::string list = testing::cartesian_list(0.0);
  EXPECT_THAT(refused(replaced(list, "P3", "Q3"), answers, "tracker"),
              HasSubstr("t.txt:5: point A::cloud::Q3 has no commanded position"));
  EXPECT_THAT(refused(replaced(list, "A, cloud, P4", "A, P4"), answers, "tracker"),
              HasSubstr("t.txt:6: the row has 5 cells"));
  EXPECT_THAT(refused(list, answers, "tracker", "name,x_mm,y_mm\nP1,0,0\n"),
              HasSubstr("nominal.csv:1: column z_mm"));
  EXPECT_THAT(refused(list, answers, "tracker", std::string(testing::kNominalPoints) + "P1,5,5,5\n"),
              HasSubstr("nominal.csv:7: point P1 is commanded twice"));
  const std::string on_a_line = "name,x_mm,y_mm,z_mm\nP1,0,0,0\nP2,1,0,0\nP3,2,0,0\nP4,3,0,0\nP5,4,0,0\n";
  EXPECT_THAT(refused(list, answers, "tracker", on_a_line), HasSubstr("lie on a line"));
  ImportAnswers inches = answers;
  inches.unit = "inch";
  EXPECT_THAT(refused(list, inches, "tracker"), HasSubstr("check --unit"));
}

TEST_F(TablesAndPoints, WordsOfHeaders) {
  EXPECT_THAT(header_words("Pos. X [mm]").words, ElementsAre("pos", "x"));
  EXPECT_EQ(header_words("Pos. X [mm]").unit, "mm");
  EXPECT_EQ(header_words("deviation_um").unit, "um");
  EXPECT_EQ(header_words("X").unit, "");
  EXPECT_EQ(header_words("X").letter(), 'x');
  EXPECT_EQ(header_words("x y").letter(), 0);
  EXPECT_THAT(header_words("").words, IsEmpty());
  EXPECT_NEAR(*factor_to_unit("gon", "deg"), 0.9, 1e-15);
  EXPECT_NEAR(*factor_to_unit("arcsec", "urad"), 4.84813681109536, 1e-12);
  EXPECT_NEAR(*factor_to_unit("inch", "mm"), 25.4, 1e-12);
  EXPECT_FALSE(factor_to_unit("mm", "deg"));
}

}  // namespace
}  // namespace volcal
