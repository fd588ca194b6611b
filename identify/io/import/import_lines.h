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
/// The same, where the other of the two signs may separate thousands: "1,234.5" with a decimal point.
std::optional<double> grouped_number(std::string_view text, char decimal);
/// "1,000" or "-12,500": three decimals, or thousands. Its decimal sign is open.
bool may_hold_thousands(std::string_view text);
/// The decimal signs that stand in the numbers of a file.
class SeenSigns {
 public:
  void add(std::string_view number, int line);
  /// '.' where no number has a comma. Throws InputError: commas and points in one file, or commas that may
  /// all separate thousands.
  char decimal(const std::string& file) const;

 private:
  int comma_line_ = 0, point_line_ = 0;
  bool comma_is_decimal_ = false;
  std::string thousands_;  ///< the first number that may hold a separator of thousands
};

/// A whole number from 0 to 10^6.
std::optional<int> whole_number(std::string_view text);

}  // namespace volcal
