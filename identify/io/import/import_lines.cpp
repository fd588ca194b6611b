#include "volcal/identify/io/import/import_lines.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace volcal {

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

std::optional<int> whole_number(std::string_view text) {
  constexpr std::size_t kMostDigits = 6;
  const bool digits = std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  if (text.empty() || text.size() > kMostDigits || !digits) return std::nullopt;
  int value = 0;
  for (const char c : text) value = 10 * value + (c - '0');
  return value;
}

}  // namespace volcal
