#include "volcal/identify/io/import/table_layout.h"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>

#include "volcal/identify/io/import/import_lines.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

constexpr std::ptrdiff_t kMostColumns = 10000;
constexpr double kLeastShareOfNumbers = 0.5;  // of the cells of a text that resembles a table
constexpr std::array kDelimiters = {'\t', ';', ',', '|', ' '};

std::vector<std::string> quoted_cells(std::string_view line, char delimiter) {
  std::vector<std::string> cells = {""};
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == delimiter && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  for (std::string& cell : cells) cell = std::string(without_blanks(cell));
  return cells;
}

std::vector<std::string> cells_of(std::string_view line, char delimiter) {
  if (delimiter != ' ') return quoted_cells(line, delimiter);
  std::vector<std::string> cells;
  for (const std::string_view word : words_between_blanks(line)) cells.emplace_back(word);
  return cells;
}

std::size_t marker_length(std::string_view line) {
  if (line.starts_with("//")) return 2;
  return line.starts_with('#') || line.starts_with('!') ? 1 : 0;
}

/// With the decimal sign that the user says, or with either.
std::optional<double> number_in(const std::string& cell, std::optional<char> decimal) {
  return decimal ? grouped_number(cell, *decimal) : foreign_number(cell);
}

std::size_t count_of_numbers(const std::vector<std::string>& cells, std::optional<char> decimal) {
  return static_cast<std::size_t>(std::ranges::count_if(
      cells, [&](const std::string& cell) { return number_in(cell, decimal).has_value(); }));
}

/// Rows with numbers by one delimiter, of the number of cells that fits best.
struct SplitTable {
  std::size_t columns = 0;
  std::size_t rows = 0;
  double score = 0.0;  ///< cells that are numbers, times their share
};

SplitTable split_table(const std::vector<TextLine>& lines, char delimiter, std::optional<char> decimal) {
  std::map<std::size_t, std::pair<std::size_t, std::size_t>> by_count;  // rows, numbers
  for (const TextLine& line : lines) {
    if (std::ranges::count(line.text, delimiter) > kMostColumns) continue;
    const auto cells = cells_of(line.text, delimiter);
    const std::size_t count = count_of_numbers(cells, decimal);
    if (count == 0) continue;
    auto& [rows, numbers] = by_count[cells.size()];
    ++rows;
    numbers += count;
  }
  SplitTable best;
  for (const auto& [columns, counts] : by_count) {
    const double numbers = static_cast<double>(counts.second);
    const double score = numbers * numbers / static_cast<double>(columns * counts.first);
    if (columns >= 2 && score > best.score) best = {columns, counts.first, score};
  }
  return best;
}

bool is_unit_cell(const std::string& cell) {
  return cell.empty() || cell == "-" || (cell.starts_with('[') && cell.ends_with(']')) ||
         (cell.starts_with('(') && cell.ends_with(')'));
}

class LayoutGuess {
 public:
  explicit LayoutGuess(const ImportSource& source) : file_(source.path), decimal_(source.decimal) {
    for (const TextLine& line : lines_with_text(source.text)) {
      lines_.push_back(line);
      if (marker_length(line.text) == 0) content_.push_back(line);
    }
  }

  TableLayout guess() {
    choose_delimiter();
    find_numeric_columns();
    const std::size_t first = first_row();
    read_header(first);
    read_rows(first);
    choose_decimal();
    return std::move(layout_);
  }

 private:
  bool is_number(const std::string& cell) const { return number_in(cell, decimal_).has_value(); }

  void choose_delimiter() {
    double best = 0.0;
    for (const char delimiter : kDelimiters) {
      const SplitTable split = split_table(content_, delimiter, decimal_);
      if (split.score <= best) continue;
      best = split.score;
      layout_.delimiter = delimiter;
      columns_ = split.columns;
    }
    if (columns_ == 0)
      throw InputError({file_, lines_.empty() ? 0 : lines_.front().number},
                       "no table of numbers is found: no delimiter gives rows of two cells or more",
                       "rows of numbers separated by tab, semicolon, comma, | or blanks are read");
  }

  void find_numeric_columns() {
    std::vector<std::size_t> numbers(columns_, 0);
    std::size_t rows = 0;
    for (const TextLine& line : content_) {
      const auto cells = cells_of(line.text, layout_.delimiter);
      if (cells.size() != columns_ || count_of_numbers(cells, decimal_) == 0) continue;
      ++rows;
      for (std::size_t k = 0; k < columns_; ++k) numbers[k] += is_number(cells[k]) ? 1 : 0;
    }
    for (const std::size_t count : numbers) layout_.numeric.push_back(2 * count >= rows && count > 0);
    if (std::ranges::none_of(layout_.numeric, [](bool numeric) { return numeric; }))
      throw InputError({file_, content_.front().number}, "no column of numbers is found",
                       "rows of numbers below a header are expected");
  }

  bool is_row(const std::vector<std::string>& cells) const {
    if (cells.size() != columns_) return false;
    for (std::size_t k = 0; k < columns_; ++k) {
      if (layout_.numeric[k] && !is_number(cells[k])) return false;
    }
    return true;
  }

  /// Place in lines_ of the first row of numbers.
  std::size_t first_row() const {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (marker_length(lines_[i].text) == 0 && is_row(cells_of(lines_[i].text, layout_.delimiter))) return i;
    }
    throw InputError({file_, content_.front().number}, "no row has a number in each column of numbers",
                     "rows of numbers below a header are expected");
  }

  /// Cells of a line above the rows that may be their header; empty when it is none.
  std::vector<std::string> header_cells(std::size_t i) const {
    const std::string_view text = lines_[i].text;
    auto cells = cells_of(without_blanks(text.substr(marker_length(text))), layout_.delimiter);
    if (cells.size() != columns_ || count_of_numbers(cells, decimal_) > 0) cells.clear();
    return cells;
  }

  void read_header(std::size_t first) {
    std::size_t at = first;
    std::vector<std::string> units;
    if (at > 0) {
      layout_.header = header_cells(at - 1);
      if (!layout_.header.empty()) --at;
      if (!layout_.header.empty() && std::ranges::all_of(layout_.header, is_unit_cell) && at > 0) {
        units = std::exchange(layout_.header, header_cells(at - 1));
        if (!layout_.header.empty()) --at;
      }
    }
    if (!layout_.header.empty()) layout_.header_line = lines_[at].number;
    for (std::size_t k = 0; k < units.size() && k < layout_.header.size(); ++k) {
      if (!units[k].empty() && units[k] != "-") layout_.header[k] += " " + units[k];
    }
    for (std::size_t i = 0; i < at; ++i) layout_.above.push_back(lines_[i]);
  }

  void read_rows(std::size_t first) {
    for (std::size_t i = first; i < lines_.size(); ++i) {
      const TextLine& line = lines_[i];
      if (marker_length(line.text) > 0) {
        layout_.above.push_back(line);
        continue;
      }
      auto cells = cells_of(line.text, layout_.delimiter);
      if (cells.size() != columns_) fail_cells(line, cells.size());
      for (std::size_t k = 0; k < columns_; ++k) {
        if (layout_.numeric[k] && !is_number(cells[k])) fail_number(line, k, cells[k]);
      }
      layout_.rows.push_back({line.number, std::move(cells)});
    }
  }

  [[noreturn]] void fail_cells(const TextLine& line, std::size_t cells) const {
    throw InputError({file_, line.number},
                     "the row has " + std::to_string(cells) + " cells, the rows above " +
                         std::to_string(columns_) + " (separated by " + delimiter_name(layout_.delimiter) +
                         ")",
                     "was it cut off? complete or delete it");
  }

  [[noreturn]] void fail_number(const TextLine& line, std::size_t column, const std::string& cell) const {
    const std::string name =
        layout_.header.empty() ? std::to_string(column + 1) : "\"" + layout_.header[column] + "\"";
    throw InputError(
        {file_, line.number},
        "column " + printable(name) + " holds \"" + printable(cell) + "\", not a number",
        "plain numbers without units are expected; where they have separators of thousands, give "
        "--decimal point or comma");
  }

  void choose_decimal() {
    if (decimal_) {
      layout_.decimal = *decimal_;
      return;
    }
    SeenSigns seen;
    for (const TableRow& row : layout_.rows) {
      for (std::size_t k = 0; k < columns_; ++k) {
        if (layout_.numeric[k]) seen.add(row.cells[k], row.line);
      }
    }
    layout_.decimal = seen.decimal(file_);
  }

  const std::string& file_;
  std::optional<char> decimal_;
  std::vector<TextLine> lines_, content_;
  std::size_t columns_ = 0;
  TableLayout layout_;
};

}  // namespace

double TableLayout::number(const TableRow& row, std::size_t column) const {
  return grouped_number(row.cells.at(column), decimal).value_or(0.0);
}

TableLayout guess_table_layout(const ImportSource& source) { return LayoutGuess(source).guess(); }

bool resembles_table(const ImportSource& source) {
  const std::vector<TextLine> lines = lines_with_text(source.text);
  return std::ranges::any_of(kDelimiters, [&](char delimiter) {
    const SplitTable split = split_table(lines, delimiter, source.decimal);
    const double cells = static_cast<double>(split.columns * split.rows);
    return split.rows >= 2 && split.score >= kLeastShareOfNumbers * kLeastShareOfNumbers * cells;
  });
}

std::string lines_beside(const TableLayout& layout) {
  if (layout.above.empty()) return "";
  return std::to_string(layout.above.size()) + (layout.above.size() == 1 ? " line" : " lines") +
         ", first \"" + printable(std::string(layout.above.front().text)) + "\"";
}

std::string delimiter_name(char delimiter) {
  return delimiter == '\t'  ? "tab"
         : delimiter == ';' ? "semicolon"
         : delimiter == ',' ? "comma"
         : delimiter == '|' ? "|"
                            : "blanks";
}

}  // namespace volcal
