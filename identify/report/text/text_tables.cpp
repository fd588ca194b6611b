#include "volcal/identify/report/text/text_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace volcal {
namespace {

constexpr std::string_view kColumnGap = "  ";

std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;  // continuation bytes of UTF-8 take no place
  }));
}

std::string padded(const std::string& text, std::size_t width, Align align) {
  const std::string blanks(width - width_of(text), ' ');
  return align == Align::Left ? text + blanks : blanks + text;
}

bool prints_as_zero(const std::string& digits) {
  return digits.find_first_of("123456789") == std::string::npos;
}

}  // namespace

TextTable::TextTable(std::vector<TextColumn> columns, std::string title)
    : columns_(std::move(columns)), title_(std::move(title)) {}

void TextTable::add_row(std::vector<std::string> cells) {
  if (cells.size() != columns_.size()) {
    throw std::invalid_argument(
        fmt::format("a row of {} cells in a table of {} columns", cells.size(), columns_.size()));
  }
  rows_.push_back(std::move(cells));
}

std::string TextTable::line(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths,
                            int indent) const {
  std::string text(static_cast<std::size_t>(indent), ' ');
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) text += kColumnGap;
    text += padded(cells[i], widths[i], columns_[i].align);
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text + '\n';
}

std::string TextTable::text(int indent) const {
  if (rows_.empty()) return {};
  std::vector<std::string> headers;
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    headers.push_back(columns_[i].header);
    std::size_t width = width_of(columns_[i].header);
    for (const auto& row : rows_) width = std::max(width, width_of(row[i]));
    widths.push_back(width);
  }
  std::string text = title_.empty() ? std::string() : title_ + '\n';
  text += line(headers, widths, indent);
  for (const auto& row : rows_) text += line(row, widths, indent);
  return text;
}

std::string fixed_number(double value, int decimals) {
  if (std::isnan(value)) return "-";
  std::string digits = fmt::format("{:.{}f}", value, decimals);
  if (digits.front() == '-' && prints_as_zero(digits)) digits.erase(0, 1);
  return digits;
}

std::string short_number(double value, int digits) {
  if (std::isnan(value)) return "-";
  const double magnitude = std::abs(value);
  if (magnitude == 0.0 || !std::isfinite(value)) return fmt::format("{:g}", magnitude == 0.0 ? 0.0 : value);
  if (magnitude < 1e-4 || magnitude >= 1e6) return fmt::format("{:.{}e}", value, std::max(0, digits - 1));
  const int decimals = digits - 1 - static_cast<int>(std::floor(std::log10(magnitude)));
  return fixed_number(value, std::max(0, decimals));
}

std::string functional_point_words(const std::string& tool) {
  return tool.empty() ? "at the spindle reference" : "tool " + tool;
}

std::string count_number(long long value) {
  std::string digits = fmt::format("{}", value);
  const std::size_t first = value < 0 ? 1 : 0;
  for (std::size_t place = digits.size(); place > first + 3;) {
    place -= 3;
    digits.insert(place, ",");
  }
  return digits;
}

}  // namespace volcal
