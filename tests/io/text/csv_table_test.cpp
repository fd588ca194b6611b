#include "volcal/identify/text/csv_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "tests/support/refusal.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

CsvColumns read(const std::string& text, const CsvFormat& format = {}) {
  const CsvTable table = CsvTable::parse(text, "t.csv", format);
  std::vector<std::size_t> all(table.header().size());
  std::iota(all.begin(), all.end(), 0U);
  return table.numbers(all);
}

std::string refusal_of_table(const std::string& text, const CsvFormat& format = {}) {
  return testing::refusal([&] { read(text, format); });
}

TEST(CsvTable, ReadsNumbersInAllTheirSpellings) {
  const CsvColumns columns = read("a,b,c\n1,-2.5,+3e-2\n 4 ,\t.5,6.\n");
  EXPECT_THAT(columns.values[0], ElementsAre(1.0, 4.0));
  EXPECT_THAT(columns.values[1], ElementsAre(-2.5, 0.5));
  EXPECT_THAT(columns.values[2], ElementsAre(0.03, 6.0));
}

TEST(CsvTable, KeepsTheLineNumbersOfTheFile) {
  const CsvColumns columns = read("# by hand\n\na,b\r\n1,2\r\n\r\n# pause\n3,4\n5,6");
  EXPECT_THAT(columns.source_line, ElementsAre(4, 7, 8));
  EXPECT_THAT(columns.values[1], ElementsAre(2.0, 4.0, 6.0));
}

TEST(CsvTable, ReadsSemicolonsDecimalCommasQuotesAndByteOrderMark) {
  const CsvColumns columns = read(
      "\xEF\xBB\xBF"
      "Report\n\"x; target\";\"say \"\"y\"\"\"\n\"1,5\";2,5\n",
      {.delimiter = ';', .decimal = ',', .skip_rows = 1});
  EXPECT_THAT(columns.values[0], ElementsAre(1.5));
  EXPECT_THAT(columns.values[1], ElementsAre(2.5));
  const CsvTable table =
      CsvTable::parse("\"x; target\";\"say \"\"y\"\"\"\n1;2\n", "t.csv", {.delimiter = ';'});
  EXPECT_THAT(table.header(), ElementsAre("x; target", "say \"y\""));
}

TEST(CsvTable, ConvertsOnlyTheColumnsAskedFor) {
  const CsvTable table = CsvTable::parse("a,remark,b\n1,good,2\n3,,4\n", "t.csv", {});
  const CsvColumns columns = table.numbers(std::vector<std::size_t>{2, 0});
  EXPECT_THAT(columns.values[0], ElementsAre(2.0, 4.0));
  EXPECT_THAT(columns.values[1], ElementsAre(1.0, 3.0));
}

TEST(CsvTable, FindsColumnsByName) {
  const CsvTable table = CsvTable::parse("a,b,b\n1,2,3\n", "t.csv", {});
  EXPECT_EQ(table.find("a"), 0U);
  EXPECT_FALSE(table.find("c").has_value());
  EXPECT_THROW(table.find("b"), InputError);
}

TEST(CsvTable, NoticesAnotherDelimiter) {
  EXPECT_EQ(CsvTable::parse("a;b\n1;2\n", "t.csv", {}).other_delimiter(), ';');
  EXPECT_EQ(CsvTable::parse("a\tb\n1\t2\n", "t.csv", {}).other_delimiter(), '\t');
  EXPECT_FALSE(CsvTable::parse("a,b\n1,2\n", "t.csv", {}).other_delimiter().has_value());
}

TEST(CsvTable, NamesLineAndColumnOfABadCell) {
  EXPECT_EQ(refusal_of_table("a,b\n1,2\n3,x\n"),
            "t.csv:3: column b holds \"x\", not a number (write plain numbers without units or thousands "
            "separators; "
            "skip_rows skips lines above the header)");
  EXPECT_THAT(refusal_of_table("a,b\n1,\n"), HasSubstr("t.csv:2: column b is empty"));
  EXPECT_THAT(refusal_of_table("a,b\n1\n"),
              HasSubstr("t.csv:2: the row has 1 cell, the header has 2; column b is missing"));
  EXPECT_THAT(refusal_of_table("a,b\n1,1.2.3\n"), HasSubstr("not a number"));
  EXPECT_THAT(refusal_of_table("a,b\n1,1e400\n"), HasSubstr("no double can hold"));
  EXPECT_THAT(refusal_of_table("a,b\n1,--2\n"), HasSubstr("not a number"));
  EXPECT_THAT(refusal_of_table("a,b\n1,+\n"), HasSubstr("not a number"));
  EXPECT_THAT(refusal_of_table("a,b\n1,+-2\n"), HasSubstr("t.csv:2: column b holds \"+-2\", not a number"));
  EXPECT_THAT(refusal_of_table("a,b\n1,++2\n"), HasSubstr("not a number"));
  EXPECT_THAT(refusal_of_table("a;b\n1;+-2,5\n", {.delimiter = ';', .decimal = ','}),
              HasSubstr("not a number"));
}

/// Rows in a form that is read at once stand between others; a long tail keeps all of them away from the end.
TEST(CsvTable, RowsOfPlainNumbersAndOthersAreTheSameTable) {
  const std::string tail = "7,seven,7.5\n# the end of the file, far behind the rows\n";
  const std::string rows[] = {"1.5,one,-2\n",    "1.5,one,-2\r\n",     " 1.5,one,-2\n",
                              "+1.5,one,-2\n",   "15e-1,one,-2.0\n",   "\"1.5\",\"o,e\",-2\n",
                              "1.5, one ,-2 \n", "1.5,\"a\"\"b\",-2\n"};
  std::string text = "a,remark,b\n";
  for (const std::string& row : rows) text += row + "# comment 1,2,3\n\n" + rows[0];
  const CsvTable table = CsvTable::parse(text + tail, "t.csv", {});
  const CsvColumns columns = table.numbers(std::vector<std::size_t>{0, 2});
  ASSERT_EQ(columns.size(), 2 * std::size(rows) + 1);
  for (std::size_t i = 0; i + 1 < columns.size(); ++i) {
    EXPECT_EQ(columns.values[0][i], 1.5) << i;
    EXPECT_EQ(columns.values[1][i], -2.0) << i;
    EXPECT_EQ(columns.source_line[i], static_cast<std::int64_t>(2 + i / 2 * 4 + (i % 2) * 3)) << i;
  }
  for (const char* bad : {"1,2\n", "1,2,3,4\n", "1,2,x\n", "1,2,3x\n", "1,2,1.2.3\n", "1,2,+-3\n", "1,2,\n"})
    EXPECT_THAT(refusal_of_table("a,remark,b\n1,1,1\n" + std::string(bad) + "1,1,1\n# far behind the rows\n"),
                HasSubstr("t.csv:3: "))
        << bad;
}

TEST(CsvTable, ReadsAMillionReadingsWithinTheFileAndEightBytesPerCell) {
  std::string text = "a,b,c\n";
  for (int i = 0; i < 1000000; ++i) text += "1.25,-300.125,4\n";
  const CsvColumns columns = read(text);
  EXPECT_EQ(columns.size(), 1000000U);
  EXPECT_LE(columns.values[0].capacity(), 1000002U);
  EXPECT_EQ(columns.source_line.back(), 1000001);
}

}  // namespace
}  // namespace volcal
