#pragma once
/// Character encodings of text files. Inside the program every text is UTF-8.

#include <string>
#include <string_view>
#include <vector>

namespace volcal {

enum class TextEncoding { Utf8, Latin1, Cp1252 };

/// Values of the key `encoding`, in the order of TextEncoding.
const std::vector<std::string>& encoding_names();

bool is_utf8(std::string_view text);
/// Length of the well-formed UTF-8 character at the beginning of `text`; 0 when there is none.
std::size_t utf8_length(std::string_view text);
/// The character turns a terminal's state or the order of its text: C0 and C1 controls, DEL, line and
/// paragraph separators, marks and overrides of direction. `character`: one in UTF-8.
bool is_control(std::string_view character);
bool holds_control(std::string_view text);
/// `text` as UTF-8. Bytes that Windows-1252 leaves open become U+FFFD.
std::string to_utf8(std::string_view text, TextEncoding encoding);

}  // namespace volcal
