#pragma once
/// Lines, words and numbers of files of foreign origin.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace volcal {

struct TextLine {
  std::string_view text;  ///< without blanks at its ends
  int number = 0;         ///< 1-based
};

/// Lines of a text that are not blank; ends LF or CRLF.
std::vector<TextLine> lines_with_text(std::string_view text);
/// Parts between blanks and tabs.
std::vector<std::string_view> words_between_blanks(std::string_view text);
std::string_view without_blanks(std::string_view text);
std::string lower_case(std::string_view text);

/// A finite number with a decimal point or, where it has no point, one decimal comma; no unit, no separators
/// of thousands. Nothing for other texts.
std::optional<double> foreign_number(std::string_view text);
/// The same with one of the two decimal signs.
std::optional<double> foreign_number(std::string_view text, char decimal);
/// A whole number from 0 to 10^6.
std::optional<int> whole_number(std::string_view text);

}  // namespace volcal
