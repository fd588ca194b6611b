#include "volcal/identify/text/toml_document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/refusal.h"
#include "volcal/identify/text/nearest_name.h"

namespace volcal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TomlTable root_of(const std::string& text) { return TomlDocument::parse(text, "t.toml").root(); }

TEST(TomlDocument, GivesNumbersInSi) {
  const TomlTable table =
      root_of("a_mm = 250\nb_um = 1.5\nc_deg = 180\nd_urad = 2\ne_um_per_m_K = 11.5\nf = 3\n");
  EXPECT_DOUBLE_EQ(*table.number("a_mm"), 0.25);
  EXPECT_DOUBLE_EQ(*table.number("b_um"), 1.5e-6);
  EXPECT_DOUBLE_EQ(*table.number("c_deg"), 3.14159265358979323846);
  EXPECT_DOUBLE_EQ(*table.number("d_urad"), 2e-6);
  EXPECT_DOUBLE_EQ(*table.number("e_um_per_m_K"), 11.5e-6);
  EXPECT_DOUBLE_EQ(*table.number("f"), 3.0);
  EXPECT_DOUBLE_EQ(*table.raw_number("a_mm"), 250.0);
  EXPECT_FALSE(table.number("absent_mm").has_value());
}

TEST(TomlDocument, KnowsTheLineOfEveryKey) {
  const TomlTable table = root_of("\n[one]\n\na = 1\n[[many]]\nb = 2\n[[many]]\nb = 3\n");
  EXPECT_EQ(table.required_table("one").place("a").line, 4);
  const auto many = table.tables("many");
  ASSERT_EQ(many.size(), 2U);
  EXPECT_EQ(many[1].place().line, 7);
  EXPECT_EQ(many[1].place("b").line, 8);
  EXPECT_EQ(many[1].path(), "many[2]");
}

TEST(TomlDocument, KeepsTheOrderOfTheFile) {
  EXPECT_THAT(root_of("z = 1\na = 2\nm = 3\n").keys(), ElementsAre("z", "a", "m"));
}

TEST(TomlDocument, RejectsTheFirstUnknownKey) {
  const TomlDocument document =
      TomlDocument::parse("length_mm = 1\n[sub]\nwidht = 2\nhieght = 3\n", "t.toml");
  const TomlTable root = document.root();
  root.number("length_mm");
  const TomlTable sub = *root.table("sub");
  sub.number("width");
  sub.number("height");
  EXPECT_EQ(testing::refusal([&] { document.reject_unknown(); }),
            "t.toml:3: unknown key sub.widht (did you mean \"width\"?)");
}

TEST(TomlDocument, NamesTheConversionWhenOnlyTheUnitDiffers) {
  EXPECT_EQ(testing::refusal([] { root_of("station_um = 5").required_number("station_mm"); }),
            "t.toml:1: unknown key station_um (write station_mm, in mm: 1 um = 0.001 mm)");
  EXPECT_EQ(testing::refusal([] { root_of("limit_um = 5").required_number("limit_urad"); }),
            "t.toml:1: unknown key limit_um (write limit_urad, in urad)");
}

TEST(TomlDocument, ChecksTypesAndBounds) {
  const TomlTable table =
      root_of("n = 1.5\ns = \"x\"\nv = [1, 2]\nd = 2024-01-01\ni = 9223372036854775807\n");
  EXPECT_THAT(testing::refusal([&] { table.integer("n", 0, 9); }),
              HasSubstr("n is a number, expected an integer"));
  EXPECT_THAT(testing::refusal([&] { table.number("s"); }),
              HasSubstr("s is the text \"x\", expected a number"));
  EXPECT_THAT(testing::refusal([&] { table.vector3("v"); }), HasSubstr("2 numbers, expected 3"));
  EXPECT_THAT(testing::refusal([&] { table.text("d"); }), HasSubstr("d is a date or time"));
  EXPECT_THAT(testing::refusal([&] { table.integer("i", 0, 9); }), HasSubstr("it must be 0 to 9"));
  EXPECT_THAT(testing::refusal([&] { table.number("n", {2.0, 3.0}); }), HasSubstr("it must be at least 2"));
  EXPECT_THAT(testing::refusal([&] { table.table("n"); }), HasSubstr("expected a table [n]"));
  EXPECT_THAT(testing::refusal([&] { table.tables("n"); }), HasSubstr("expected tables [[n]]"));
}

TEST(TomlDocument, ReadsASchemaIntoOptions) {
  const std::vector<KeySchema> schema = {
      {.key = "station", .type = KeyType::Text, .help = ""},
      {.key = "station_mm", .type = KeyType::Vector3, .required = true, .help = "", .plausible_max = 1e5},
      {.key = "free", .type = KeyType::Boolean, .help = ""},
      {.key = "lead_mm", .help = "", .plausible_min = 0.5, .plausible_max = 100.0}};
  const Options options =
      root_of("station = \"P1\"\nstation_mm = [1, 2, 3]\nfree = true\nlead_mm = 10\n").options(schema);
  EXPECT_EQ(options.text("station"), "P1");
  EXPECT_TRUE(options.vector("station")->isApprox(Eigen::Vector3d(1e-3, 2e-3, 3e-3)));
  EXPECT_EQ(options.boolean("free"), true);
  EXPECT_DOUBLE_EQ(*options.number("lead"), 0.01);
  EXPECT_EQ(testing::refusal([&] { root_of("station_mm = [1, 2, 3]\nlead_mm = 0.01\n").options(schema); }),
            "t.toml:2: lead_mm = 0.01 mm is too small (0 or at least 0.5 mm is believed; wrong unit by 1000? "
            "lead is "
            "stated in mm, write 10)");
}

TEST(NearestName, FindsSlipsOfThePenOnly) {
  const std::vector<std::string> names = {"station", "tool", "data", "instrument"};
  EXPECT_EQ(nearest_name("staiton", names), "station");
  EXPECT_EQ(nearest_name("Tool", names), "tool");
  EXPECT_EQ(nearest_name("instruments", names), "instrument");
  EXPECT_FALSE(nearest_name("colour", names).has_value());
}

}  // namespace
}  // namespace volcal
