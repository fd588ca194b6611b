#include "volcal/identify/text/table_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace volcal {
namespace {

constexpr std::size_t kShownCharacters = 40;
constexpr double kLargestNumber = 1e12;  // of anything in a table, in any unit

/// Printable and short.
std::string shown(std::string_view text) {
  std::string result;
  for (const char c : text.substr(0, kShownCharacters)) result += c >= ' ' && c <= '~' ? c : '?';
  return "\"" + result + (text.size() > kShownCharacters ? "...\"" : "\"");
}

double number_in(std::string_view cell, std::string_view what, const SourcePlace& place) {
  std::string_view digits = trimmed_text(cell);
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool whole = error == std::errc() && end == digits.data() + digits.size() && !digits.empty();
  if (whole && std::isfinite(value) && std::abs(value) <= kLargestNumber) return value;
  throw InputError(place, std::string(what) + " is " + shown(cell) + ", not a number of a table",
                   "write a number with a decimal point and no unit, or write the table again");
}

}  // namespace

const TableFile* find_file(std::span<const TableFile> files, std::string_view name) {
  const auto found = std::ranges::find(files, name, &TableFile::name);
  return found == files.end() ? nullptr : &*found;
}

std::string whole_content(const TableFile& file) {
  std::string text = file.content;
  if (file.further) file.further([&text](std::string_view piece) { text += piece; });
  return text;
}

const TableFile& file_named(std::span<const TableFile> files, std::string_view name) {
  if (const TableFile* found = find_file(files, name)) return *found;
  throw InputError({std::string(name), 0}, "the file is missing among the tables",
                   "give the whole folder that volcal tables wrote");
}

bool TableLines::advance() {
  const std::string_view text = file_.content;
  if (next_ >= text.size()) return false;
  const std::size_t stop = std::min(text.find('\n', next_), text.size());
  current_ = text.substr(next_, stop - next_);
  if (current_.ends_with('\r')) current_.remove_suffix(1);
  next_ = stop + 1;
  ++line_;
  return true;
}

bool TableLines::advance_to_content() {
  while (advance()) {
    if (!trimmed_text(current_).empty()) return true;
  }
  return false;
}

void TableLines::fail(const std::string& problem, const std::string& remedy) const {
  throw InputError(place(), problem, remedy);
}

double TableLines::number(std::string_view cell, std::string_view what) const {
  return number_in(cell, what, place());
}

int TableLines::integer(std::string_view cell, std::string_view what) const {
  const double value = number(cell, what);
  if (value != std::floor(value) || std::abs(value) > std::numeric_limits<int>::max())
    fail(std::string(what) + " is " + shown(cell) + ", not a whole number", "write a whole number");
  return static_cast<int>(value);
}

std::string_view trimmed_text(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  constexpr std::string_view kBlanks = " \t\r";
  for (std::size_t from = line.find_first_not_of(kBlanks); from != std::string_view::npos;) {
    const std::size_t stop = std::min(line.find_first_of(kBlanks, from), line.size());
    words.push_back(line.substr(from, stop - from));
    from = line.find_first_not_of(kBlanks, stop);
  }
  return words;
}

std::vector<std::string> csv_cells(const TableLines& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  const std::string_view text = line.current();
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '"') {
      const bool doubled = quoted && i + 1 < text.size() && text[i + 1] == '"';
      if (doubled) cells.back() += text[i++];
      quoted = doubled || !quoted;
    } else if (text[i] == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += text[i];
    }
  }
  if (quoted) line.fail("a quote does not close", "close the quote on the same line");
  return cells;
}

std::vector<CsvRow> csv_rows(const TableFile& file, std::string_view header) {
  TableLines lines(file);
  if (!lines.advance_to_content()) lines.fail("the file is empty", "write the tables again");
  if (trimmed_text(lines.current()) != header)
    lines.fail("the header is " + shown(lines.current()), "the header must be " + std::string(header));
  const auto columns = static_cast<std::size_t>(std::ranges::count(header, ',')) + 1;
  std::vector<CsvRow> rows;
  while (lines.advance_to_content()) {
    CsvRow row{lines.place(), csv_cells(lines)};
    if (row.cells.size() != columns) {
      lines.fail(
          "the row has " + std::to_string(row.cells.size()) + " cells, the header " + std::to_string(columns),
          "complete or delete the row");
    }
    rows.push_back(std::move(row));
  }
  if (rows.empty()) lines.fail("there is no row below the header", "write the tables again");
  return rows;
}

double csv_number(const CsvRow& row, std::size_t column, std::string_view name) {
  return number_in(row.cells[column], name, row.place);
}

void require_ascending(const std::vector<double>& positions, double position, const SourcePlace& place) {
  if (positions.empty() || position > positions.back()) return;
  throw InputError(place, "the position does not lie beyond the one before it",
                   "positions must ascend; sort the rows and delete repeated ones");
}

}  // namespace volcal
