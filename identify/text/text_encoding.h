#pragma once
/// Character encodings of text files. Inside the program every text is UTF-8.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace volcal {

enum class TextEncoding { Utf8, Latin1, Cp1252, Cp1250, Cp1251, Cp437, Cp850, Cp932, Gbk, Utf16 };

/// Values of the key `encoding`, in the order of TextEncoding.
const std::vector<std::string>& encoding_names();

bool is_utf8(std::string_view text);
/// Length of the well-formed UTF-8 character at the beginning of `text`; 0 when there is none.
std::size_t utf8_length(std::string_view text);
/// The character turns a terminal's state or the order of its text: C0 and C1 controls, DEL, line and
/// paragraph separators, marks and overrides of direction. `character`: one in UTF-8.
bool is_control(std::string_view character);
bool holds_control(std::string_view text);
/// The encoding of a name in encoding_names().
std::optional<TextEncoding> encoding_of_name(std::string_view name);

struct DecodedText {
  std::string text;      ///< UTF-8; bytes that the encoding leaves open are U+FFFD
  int unknown_line = 0;  ///< 1-based line of the first such byte; 0 = none
};
/// By iconv. UTF-16 without a byte order mark is little-endian; marks are left out. Throws InputError where
/// the system has no table of the encoding.
DecodedText decode(std::string_view bytes, TextEncoding encoding);
/// decode(), without the line.
std::string to_utf8(std::string_view text, TextEncoding encoding);

/// Of a text that is not UTF-8: the encoding to try first, by which bytes it has.
TextEncoding likely_encoding(std::string_view bytes);
/// What to do about a file that is not UTF-8: name the likely encoding, between `before` and `behind`, or
/// save the file again.
std::string encoding_remedy(std::string_view bytes, std::string_view before, std::string_view behind);
/// 1-based line of the first byte that is no UTF-8; 0 = there is none.
int line_not_utf8(std::string_view text);

}  // namespace volcal
