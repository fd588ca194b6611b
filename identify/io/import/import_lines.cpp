#include "volcal/identify/io/import/import_lines.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr std::size_t kDigitsOfThousands = 3;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

std::string_view without_blanks(std::string_view text) {
  const std::size_t start = text.find_first_not_of(" \t\r");
  if (start == std::string_view::npos) return {};
  return text.substr(start, text.find_last_not_of(" \t\r") - start + 1);
}

std::vector<TextLine> lines_with_text(std::string_view text) {
  std::vector<TextLine> lines;
  int number = 0;
  while (!text.empty()) {
    ++number;
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = without_blanks(text.substr(0, end));
    if (!line.empty()) lines.push_back({line, number});
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

std::vector<std::string_view> words_between_blanks(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t start = text.find_first_not_of(" \t"); start != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(" \t", start), text.size());
    words.push_back(text.substr(start, end - start));
    start = text.find_first_not_of(" \t", end);
  }
  return words;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

std::optional<double> foreign_number(std::string_view text, char decimal) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const fast_float::parse_options options(fast_float::chars_format::general, decimal);
  const auto end = fast_float::from_chars_advanced(text.data(), text.data() + text.size(), value, options);
  const bool whole = end.ec == std::errc() && end.ptr == text.data() + text.size() && !text.empty();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<double> foreign_number(std::string_view text) {
  const bool comma = text.find('.') == std::string_view::npos && std::ranges::count(text, ',') == 1;
  return foreign_number(text, comma ? ',' : '.');
}

std::optional<double> grouped_number(std::string_view text, char decimal) {
  const char separator = decimal == '.' ? ',' : '.';
  const std::string_view whole = text.substr(0, text.find(decimal));
  std::size_t digits = 0, groups = 0;
  std::string plain;
  for (const char c : whole) {
    const bool ends_group = c == separator;
    if (ends_group && (digits == 0 || digits > kDigitsOfThousands)) return std::nullopt;
    if (ends_group && groups > 0 && digits != kDigitsOfThousands) return std::nullopt;
    groups += ends_group ? 1 : 0;
    digits = ends_group ? 0 : digits + (is_digit(c) ? 1 : 0);
    if (!ends_group) plain += c;
  }
  if (groups > 0 && digits != kDigitsOfThousands) return std::nullopt;
  return foreign_number(plain + std::string(text.substr(whole.size())), decimal);
}

bool may_hold_thousands(std::string_view text) {
  if (text.starts_with('+') || text.starts_with('-')) text.remove_prefix(1);
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos || comma == 0 || comma > kDigitsOfThousands) return false;
  const std::string_view behind = text.substr(comma + 1);
  return text[0] != '0' && behind.size() == kDigitsOfThousands && std::ranges::all_of(behind, is_digit) &&
         std::ranges::all_of(text.substr(0, comma), is_digit);
}

void SeenSigns::add(std::string_view number, int line) {
  if (number.find('.') != std::string_view::npos && point_line_ == 0) point_line_ = line;
  if (number.find(',') == std::string_view::npos) return;
  if (comma_line_ == 0) comma_line_ = line;
  if (!may_hold_thousands(number)) {
    comma_is_decimal_ = true;
  } else if (thousands_.empty()) {
    thousands_ = std::string(number);
  }
}

char SeenSigns::decimal(const std::string& file) const {
  if (comma_line_ == 0) return '.';
  if (point_line_ > 0)
    throw InputError({file, std::max(comma_line_, point_line_)},
                     "decimal commas and decimal points stand in one file, first in lines " +
                         std::to_string(comma_line_) + " and " + std::to_string(point_line_),
                     "export it with one decimal sign; where one of the two separates thousands, give "
                     "--decimal point or comma");
  if (!comma_is_decimal_)
    throw InputError({file, comma_line_},
                     "\"" + thousands_ +
                         "\" may be a number with three decimals or with a separator of thousands; every "
                         "comma of the file stands so",
                     "give --decimal comma or --decimal point");
  return ',';
}

std::optional<int> whole_number(std::string_view text) {
  constexpr std::size_t kMostDigits = 6;
  if (text.empty() || text.size() > kMostDigits || !std::ranges::all_of(text, is_digit)) return std::nullopt;
  int value = 0;
  for (const char c : text) value = 10 * value + (c - '0');
  return value;
}

}  // namespace volcal
