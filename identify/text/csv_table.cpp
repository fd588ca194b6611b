#include "volcal/identify/text/csv_table.h"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "volcal/identify/text/plain_number.h"
#include "volcal/identify/text/text_file.h"

namespace volcal {
namespace {

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r'))
    text.remove_suffix(1);
  return text;
}

/// Lines of a text, one after the other, without their ends.
class Lines {
 public:
  Lines(std::string_view text, std::size_t offset, std::int64_t line)
      : text_(text), next_(offset), line_(line) {}

  bool advance() {
    if (next_ >= text_.size()) return false;
    const void* end = std::memchr(text_.data() + next_, '\n', text_.size() - next_);
    const std::size_t stop =
        end ? static_cast<std::size_t>(static_cast<const char*>(end) - text_.data()) : text_.size();
    current_ = text_.substr(next_, stop - next_);
    if (current_.ends_with('\r')) current_.remove_suffix(1);
    next_ = stop + 1;
    ++line_;
    return true;
  }
  /// Next line that is neither blank nor a comment.
  bool advance_to_content() {
    while (advance()) {
      if (is_content()) return true;
    }
    return false;
  }
  /// Neither blank nor a comment.
  bool is_content() const {
    const std::string_view content = trimmed(current_);
    return !content.empty() && content.front() != '#';
  }

  std::string_view current() const { return current_; }
  std::int64_t line() const { return line_; }
  std::size_t next() const { return std::min(next_, text_.size()); }

 private:
  std::string_view text_;
  std::size_t next_;
  std::int64_t line_;
  std::string_view current_;
};

/// Cells of one line. `quoted_` holds a cell whose doubled quotes had to be undone.
class Cells {
 public:
  Cells(std::string_view line, char delimiter) : rest_(line), delimiter_(delimiter) {}

  /// False at the end of the line. `closed()` tells whether a quoted cell ended properly.
  bool advance() {
    if (done_) return false;
    if (const auto start = rest_.find_first_not_of(' ');
        start != std::string_view::npos && rest_[start] == '"') {
      read_quoted(start + 1);
    } else {
      take(find_delimiter(0));
      cell_ = trimmed(cell_);
    }
    return true;
  }

  std::string_view cell() const { return cell_; }
  bool closed() const { return closed_; }

 private:
  std::size_t find_delimiter(std::size_t from) const {
    const std::size_t found = rest_.find(delimiter_, from);
    return found == std::string_view::npos ? rest_.size() : found;
  }

  void take(std::size_t stop) {
    cell_ = rest_.substr(0, stop);
    done_ = stop >= rest_.size();
    rest_.remove_prefix(done_ ? rest_.size() : stop + 1);
  }

  void read_quoted(std::size_t from) {
    quoted_.clear();
    std::size_t i = from;
    closed_ = false;
    for (; i < rest_.size(); ++i) {
      if (rest_[i] != '"') {
        quoted_ += rest_[i];
      } else if (i + 1 < rest_.size() && rest_[i + 1] == '"') {
        quoted_ += rest_[i++];
      } else {
        closed_ = true;
        break;
      }
    }
    const std::size_t stop = find_delimiter(std::min(i + 1, rest_.size()));
    if (closed_ && !trimmed(rest_.substr(i + 1, stop - i - 1)).empty()) closed_ = false;
    take(stop);
    cell_ = trimmed(quoted_);
  }

  std::string_view rest_;
  char delimiter_;
  std::string_view cell_;
  std::string quoted_;
  bool done_ = false;
  bool closed_ = true;
};

/// A number may have a plus sign, and has one sign at most.
std::string_view without_plus(std::string_view cell) {
  if (cell.starts_with('+') && !cell.starts_with("+-")) cell.remove_prefix(1);
  return cell;
}

bool is_number_with(std::string_view cell, char decimal) {
  cell = without_plus(cell);
  double value = 0.0;
  const fast_float::parse_options options(fast_float::chars_format::general, decimal);
  const auto end = fast_float::from_chars_advanced(cell.data(), cell.data() + cell.size(), value, options);
  return !cell.empty() && end.ptr == cell.data() + cell.size();
}

}  // namespace

/// Converts the rows below the header.
class CsvTable::RowReader {
 public:
  RowReader(const CsvTable& table, std::span<const std::size_t> columns)
      : table_(table), target_(table.header_.size(), kUnused) {
    for (std::size_t i = 0; i < columns.size(); ++i) target_[columns[i]] = i;
    result_.values.resize(columns.size());
    row_.resize(columns.size());
  }

  CsvColumns read() {
    const std::string_view text(table_.text_);
    const auto body = text.substr(table_.body_);
    reserve(static_cast<std::size_t>(std::count(body.begin(), body.end(), '\n')) + 1);
    const char* at = body.data();
    const char* const end = body.data() + body.size();
    line_ = table_.header_line_;
    while (at != end) {
      ++line_;
      const char* next = read_plain_row(at, end);
      at = next != nullptr ? next : read_line(at, end);
    }
    if (result_.source_line.empty()) {
      throw InputError({table_.file_, static_cast<int>(table_.header_line_)},
                       "the file has a header and no rows", "export the readings again");
    }
    return std::move(result_);
  }

 private:
  static constexpr std::size_t kUnused = std::numeric_limits<std::size_t>::max();

  void reserve(std::size_t rows) {
    for (auto& column : result_.values) column.reserve(rows);
    result_.source_line.reserve(rows);
  }

  /// Start of the next line after a row of plain numbers; null, and nothing is stored, where there is
  /// anything else, which read_line() reads or refuses.
  const char* read_plain_row(const char* at, const char* end) {
    if (!starts_row(*at)) return nullptr;
    for (std::size_t column = 0; column < target_.size(); ++column) {
      if (column > 0) {
        if (at == end || *at != table_.format_.delimiter) return nullptr;
        ++at;
      }
      at = target_[column] == kUnused
               ? end_of_plain_cell(at, end)
               : read_plain_number(at, end, table_.format_.decimal, row_[target_[column]]);
      if (at == nullptr) return nullptr;
    }
    if (at != end && *at == '\r') ++at;
    if (at == end || *at != '\n') return nullptr;
    for (std::size_t i = 0; i < row_.size(); ++i) result_.values[i].push_back(row_[i]);
    result_.source_line.push_back(line_);
    return at + 1;
  }

  /// Neither blank nor a comment.
  static bool starts_row(char first) {
    return first != '#' && first != ' ' && first != '\t' && first != '\r' && first != '\n';
  }

  const char* end_of_plain_cell(const char* at, const char* end) const {
    while (at != end && *at != table_.format_.delimiter && *at != '\n' && *at != '\r') {
      if (*at++ == '"') return nullptr;
    }
    return at;
  }

  /// Any line; returns the start of the next one.
  const char* read_line(const char* at, const char* end) {
    Lines lines({at, static_cast<std::size_t>(end - at)}, 0, 0);
    lines.advance();
    if (lines.is_content()) {
      read_row(lines.current());
      result_.source_line.push_back(line_);
    }
    return at + lines.next();
  }

  void read_row(std::string_view line) {
    Cells cells(line, table_.format_.delimiter);
    std::size_t index = 0;
    for (; cells.advance(); ++index) {
      if (index >= target_.size()) fail_cell_count(line);
      if (!cells.closed()) fail(index, "has a quote that does not close", "close the quote on the same line");
      if (target_[index] != kUnused) pending_.emplace_back(index, number(index, cells.cell(), line));
    }
    if (index != target_.size()) fail_cell_count(line);
    for (const auto& [column, value] : pending_) result_.values[target_[column]].push_back(value);
    pending_.clear();
  }

  double number(std::size_t column, std::string_view cell, std::string_view line) const {
    const std::string_view digits = without_plus(cell);
    const char* const begin = digits.data();
    const char* const end = begin + digits.size();
    double value = 0.0;
    const auto parsed = fast_float::from_chars_advanced(
        begin, end, value,
        fast_float::parse_options(fast_float::chars_format::general, table_.format_.decimal));
    if (parsed.ec == std::errc() && parsed.ptr == end && begin != end && std::isfinite(value)) return value;
    fail_number(column, cell, line, value, parsed.ptr == end && begin != end);
  }

  [[noreturn]] void fail(std::size_t column, const std::string& problem, const std::string& remedy) const {
    throw InputError({table_.file_, static_cast<int>(line_)},
                     "column " + printable(table_.header_[column]) + " " + problem, remedy);
  }

  [[noreturn]] void fail_number(std::size_t column, std::string_view cell, std::string_view line,
                                double value, bool whole) const {
    if (cell.empty()) {
      fail(column, "is empty", "every row needs a value here; delete the row if there was no reading");
    }
    const std::string shown = "holds \"" + printable(std::string(cell)) + "\"";
    if (whole && std::isnan(value)) fail(column, shown + ", not a number", "delete rows without a reading");
    if (whole) fail(column, shown + ", which no double can hold", "check the export; values must be finite");
    if (cell_count(line) > target_.size()) fail_cell_count(line);
    const char decimal = table_.format_.decimal;
    if (decimal == '.' && is_number_with(cell, ',')) {
      fail(column, shown + ", a decimal comma", "add decimal = \",\" to the setup");
    }
    if (decimal == ',' && is_number_with(cell, '.')) {
      fail(column, shown + ", a decimal point in a file read with decimal = \",\"",
           "remove decimal = \",\" from the setup");
    }
    fail(column, shown + ", not a number",
         "write plain numbers without units or thousands separators; skip_rows skips lines above the header");
  }

  std::size_t cell_count(std::string_view line) const {
    Cells cells(line, table_.format_.delimiter);
    std::size_t count = 0;
    while (cells.advance()) ++count;
    return count;
  }

  [[noreturn]] void fail_cell_count(std::string_view line) const {
    const std::size_t count = cell_count(line);
    const std::size_t expected = target_.size();
    std::string problem = "the row has " + std::to_string(count) + (count == 1 ? " cell" : " cells") +
                          ", the header has " + std::to_string(expected);
    if (count < expected) {
      problem += "; column " + printable(table_.header_[count]) + " is missing";
      throw InputError({table_.file_, static_cast<int>(line_)}, problem,
                       "was the row cut off? complete or delete it");
    }
    const bool decimal_comma = table_.format_.delimiter == ',' && count > expected + 1;
    throw InputError({table_.file_, static_cast<int>(line_)}, problem,
                     decimal_comma
                         ? "decimal commas in a comma-separated file? export it with semicolons and add "
                           "delimiter = \";\" and decimal = \",\" to the setup"
                         : "remove the extra cells or give them a name in the header");
  }

  const CsvTable& table_;
  std::vector<std::size_t> target_;
  std::vector<std::pair<std::size_t, double>> pending_;
  std::vector<double> row_;  ///< [asked column]
  CsvColumns result_;
  std::int64_t line_ = 0;
};

CsvTable CsvTable::read(const std::string& path, const CsvFormat& format, const SourcePlace& named_at) {
  return CsvTable(read_text_file(path, {format.encoding, format.encoding_only_if_not_utf8}, named_at), path,
                  format);
}

CsvTable CsvTable::parse(std::string text, const std::string& file, const CsvFormat& format) {
  require_text(text, file);
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  if (format.encoding != TextEncoding::Utf8) text = to_utf8(text, format.encoding);
  return CsvTable(std::move(text), file, format);
}

CsvTable::CsvTable(std::string text, std::string file, const CsvFormat& format)
    : text_(std::move(text)), file_(std::move(file)), format_(format) {
  Lines lines(text_, 0, 0);
  for (std::size_t i = 0; i < format_.skip_rows; ++i) lines.advance();
  if (!lines.advance_to_content()) {
    throw InputError({file_, 0}, "the file has no header row",
                     format_.skip_rows
                         ? "skip_rows = " + std::to_string(format_.skip_rows) + " skips all of it"
                         : "the first row must name the columns");
  }
  header_line_ = lines.line();
  body_ = lines.next();
  Cells cells(lines.current(), format_.delimiter);
  while (cells.advance()) header_.emplace_back(cells.cell());
  if (!cells.closed()) throw InputError(header_place(), "a quote in the header does not close", "close it");
  const auto numeric = [&](const std::string& name) { return is_number_with(name, format_.decimal); };
  if (std::ranges::any_of(header_, numeric)) {
    throw InputError(header_place(),
                     "the header row holds numbers: " + printable(std::string(lines.current())),
                     "the first row must name the columns, e.g. x_mm,y_mm,z_mm,length_mm");
  }
}

std::optional<std::size_t> CsvTable::find(std::string_view name) const {
  const auto found = std::ranges::find(header_, name);
  if (found == header_.end()) return std::nullopt;
  if (std::find(found + 1, header_.end(), name) != header_.end()) {
    throw InputError(header_place(), "column " + printable(std::string(name)) + " appears twice",
                     "remove or rename one of the two");
  }
  return static_cast<std::size_t>(found - header_.begin());
}

std::optional<char> CsvTable::other_delimiter() const {
  for (const char candidate : {';', '\t', ',', '|'}) {
    if (candidate == format_.delimiter) continue;
    const auto holds = [&](const std::string& name) { return name.find(candidate) != std::string::npos; };
    if (header_.size() <= 2 && std::ranges::any_of(header_, holds)) return candidate;
  }
  return std::nullopt;
}

CsvTable CsvTable::of_columns(std::vector<NumberColumn> columns, const std::string& name,
                              std::vector<std::int64_t> lines) {
  if (columns.empty() || columns.front().values.empty())
    throw InputError({name, 0}, "there are no readings",
                     "give one array for each column, one value per reading");
  CsvTable table;
  table.file_ = name;
  for (const NumberColumn& column : columns) {
    if (column.values.size() != columns.front().values.size()) {
      throw InputError({name, 0},
                       "column " + printable(column.name) + " has " + std::to_string(column.values.size()) +
                           " rows, column " + printable(columns.front().name) + " has " +
                           std::to_string(columns.front().values.size()),
                       "give arrays of the same length, one value per reading");
    }
    table.header_.push_back(column.name);
  }
  if (lines.empty()) {
    lines.resize(columns.front().values.size());
    std::iota(lines.begin(), lines.end(), std::int64_t{1});
  }
  table.in_memory_ = std::move(columns);
  table.lines_ = std::move(lines);
  return table;
}

CsvColumns CsvTable::numbers_in_memory(std::span<const std::size_t> columns) const {
  CsvColumns read;
  for (const std::size_t index : columns) {
    const NumberColumn& column = in_memory_[index];
    const auto wrong =
        std::ranges::find_if_not(column.values, [](double value) { return std::isfinite(value); });
    if (wrong != column.values.end()) {
      throw InputError(
          {file_, static_cast<int>(lines_.at(static_cast<std::size_t>(wrong - column.values.begin())))},
          "column " + printable(column.name) + " holds \"" + std::to_string(*wrong) +
              "\", not a finite number",
          "leave out rows without a reading");
    }
    read.values.emplace_back(column.values.begin(), column.values.end());
  }
  read.source_line = lines_;
  return read;
}

CsvColumns CsvTable::numbers(std::span<const std::size_t> columns) const {
  if (!in_memory_.empty()) return numbers_in_memory(columns);
  return RowReader(*this, columns).read();
}

}  // namespace volcal
