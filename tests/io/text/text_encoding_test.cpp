/// Code pages, by bytes of their published tables.

#include "volcal/identify/text/text_encoding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/refusal.h"
#include "tests/support/schema_samples.h"
#include "volcal/identify/io/campaign/machine_reader.h"
#include "volcal/identify/text/toml_document.h"

namespace volcal {
namespace {

using ::testing::HasSubstr;
using testing::refusal;

TEST(TextEncodings, BytesOfEachCodePage) {
  EXPECT_EQ(to_utf8("\x80 \xB5m \xFC", TextEncoding::Cp1252), "\u20AC \u00B5m \u00FC");
  EXPECT_EQ(to_utf8("\xB5m", TextEncoding::Latin1), "\u00B5m");
  EXPECT_EQ(to_utf8("\xB3", TextEncoding::Cp1250), "\u0142");
  EXPECT_EQ(to_utf8("\xCE\xF1\xFC", TextEncoding::Cp1251), "\u041E\u0441\u044C");
  EXPECT_EQ(to_utf8("\x81\xE6", TextEncoding::Cp437), "\u00FC\u00B5");
  EXPECT_EQ(to_utf8("\x81\xE6", TextEncoding::Cp850), "\u00FC\u00B5");
  EXPECT_EQ(to_utf8("\x8E\xB2", TextEncoding::Cp932), "\u8EF8");
  EXPECT_EQ(to_utf8("\xBB\xFA", TextEncoding::Gbk), "\u673A");
  EXPECT_EQ(to_utf8(std::string("\xFF\xFEX\0\xB5\0", 6), TextEncoding::Utf16), "X\u00B5");
  EXPECT_EQ(to_utf8(std::string("\xFE\xFF\0X\0\xB5", 6), TextEncoding::Utf16), "X\u00B5");
  for (const std::string& name : encoding_names()) EXPECT_EQ(to_utf8("", *encoding_of_name(name)), "");
}

TEST(TextEncodings, BytesLeftOpenAreMarkedWithTheirLine) {
  const DecodedText decoded = decode(
      "a\nb\x81"
      "c\n",
      TextEncoding::Cp1252);
  EXPECT_EQ(decoded.text, "a\nb\uFFFDc\n");
  EXPECT_EQ(decoded.unknown_line, 2);
  EXPECT_EQ(decode("abc", TextEncoding::Cp1252).unknown_line, 0);
  EXPECT_EQ(decode(std::string("\xFF\xFEX\0\0", 5), TextEncoding::Utf16).text, "X\uFFFD");
  const std::string many(100000, '\xFC');
  EXPECT_EQ(to_utf8(many, TextEncoding::Latin1).size(), 200000U);
}

TEST(TextEncodings, TheLikelyOne) {
  EXPECT_EQ(likely_encoding("Gr\xF6\xDF"
                            "e"),
            TextEncoding::Cp1252);
  EXPECT_EQ(likely_encoding("\x8E\xB2\x81\x9D"), TextEncoding::Gbk) << "81 and 9D are open in cp1252";
  EXPECT_EQ(line_not_utf8("a\nb\n\xFC"), 3);
  EXPECT_EQ(line_not_utf8("a\nb\n\u00FC"), 0);
}

TEST(TextEncodings, AMachineFileInACodePage) {
  const std::string text = testing::sample_machine();
  const std::string name = "name = \"";
  std::string named = text;
  const std::size_t at = named.find(name);
  ASSERT_NE(at, std::string::npos);
  named.insert(at + name.size(), "Fr\xE4se ");
  const std::string message = refusal([&] { parse_machine(named, "machine.toml"); });
  EXPECT_THAT(message, HasSubstr("is not UTF-8 text"));
  EXPECT_THAT(message, HasSubstr("write encoding = \"cp1252\""));
  const std::string line =
      std::to_string(1 + std::count(named.begin(), named.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
  EXPECT_THAT(message, HasSubstr("machine.toml:" + line + ":"));
  EXPECT_THAT(parse_machine("encoding = \"cp1252\"\n" + named, "machine.toml").name, HasSubstr("Fr\u00E4se"));
  EXPECT_EQ(parse_machine("encoding = \"cp1252\"\n" + text, "machine.toml").name,
            parse_machine(text, "machine.toml").name);
  EXPECT_THAT(refusal([&] { parse_machine("encoding = \"cp125\"\n" + text, "machine.toml"); }),
              HasSubstr("machine.toml:1: "));
}

}  // namespace
}  // namespace volcal
