#include "volcal/identify/report/text/text_tables.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

namespace volcal {
namespace {

TEST(TextTable, AlignsNamesLeftAndNumbersRightWithoutTrailingBlanks) {
  TextTable table({{"setup", Align::Left}, {"n"}, {"rms [um]"}}, "Setups");
  table.add_row({"S1", "12", "0.50"});
  table.add_row({"tower", "1,300", "12.25"});
  EXPECT_EQ(table.text(),
            "Setups\n"
            "  setup      n  rms [um]\n"
            "  S1        12      0.50\n"
            "  tower  1,300     12.25\n");
}

TEST(TextTable, CountsCharactersNotBytes) {
  TextTable table({{"name", Align::Left}, {"value"}});
  table.add_row(
      {"Gr\xC3\xB6\xC3\x9F"
       "e",
       "1"});
  table.add_row({"Gross", "2"});
  EXPECT_EQ(table.text(0),
            "name   value\nGr\xC3\xB6\xC3\x9F"
            "e      1\nGross      2\n");
}

TEST(TextTable, WithoutRowsPrintsNothing) { EXPECT_EQ(TextTable({{"a"}}, "title").text(), ""); }

TEST(TextTable, RefusesARowOfTheWrongLength) {
  TextTable table({{"a"}, {"b"}});
  EXPECT_THROW(table.add_row({"1"}), std::invalid_argument);
}

TEST(Numbers, MissingValuesAndNegativeZeroReadWell) {
  EXPECT_EQ(fixed_number(std::numeric_limits<double>::quiet_NaN(), 2), "-");
  EXPECT_EQ(fixed_number(-0.001, 2), "0.00");
  EXPECT_EQ(fixed_number(-0.006, 2), "-0.01");
  EXPECT_EQ(short_number(0.0), "0");
  EXPECT_EQ(short_number(1234.56), "1235");
  EXPECT_EQ(short_number(0.0123456), "0.01235");
  EXPECT_EQ(short_number(1.5e-7), "1.500e-07");
}

TEST(Numbers, CountsAreGroupedInThrees) {
  EXPECT_EQ(count_number(0), "0");
  EXPECT_EQ(count_number(999), "999");
  EXPECT_EQ(count_number(6048), "6,048");
  EXPECT_EQ(count_number(1000000), "1,000,000");
  EXPECT_EQ(count_number(-1000), "-1,000");
}

TEST(FunctionalPointWords, WithoutAToolItIsTheSpindleReference) {
  EXPECT_EQ(functional_point_words("short"), "tool short");
  EXPECT_EQ(functional_point_words(""), "at the spindle reference");
}

}  // namespace
}  // namespace volcal
