#pragma once
/// Table files as lines and cells, with errors that name file, line and remedy. Shared by the readers of
/// table formats.

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/model/description/errors.h"

namespace volcal {

using TextTaker = std::function<void(std::string_view text)>;

struct TableFile {
  std::string name;  ///< no folder in it
  std::string content;
  /// What follows `content`, made piece by piece while it is written; null where that is all.
  std::function<void(const TextTaker& take)> further = {};
};

/// Of a file, with what follows its `content`.
std::string whole_content(const TableFile& file);

/// The file of that name. Throws InputError when it is not among them.
const TableFile& file_named(std::span<const TableFile> files, std::string_view name);
const TableFile* find_file(std::span<const TableFile> files, std::string_view name);

/// Lines of a text without their ends (LF or CRLF), numbered from 1. The file must outlive it.
class TableLines {
 public:
  explicit TableLines(const TableFile& file) : file_(file) {}

  bool advance();
  /// To the next line that is not blank.
  bool advance_to_content();
  std::string_view current() const { return current_; }
  SourcePlace place() const { return {file_.name, line_}; }
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const;
  /// The whole cell as a number of at most 1e12; `what` names it in the message.
  double number(std::string_view cell, std::string_view what) const;
  int integer(std::string_view cell, std::string_view what) const;

 private:
  const TableFile& file_;
  std::size_t next_ = 0;
  int line_ = 0;
  std::string_view current_;
};

std::string_view trimmed_text(std::string_view text);
/// Cells between white space.
std::vector<std::string_view> words_of(std::string_view line);
/// Cells between commas; a quoted cell may hold commas and doubled quotes.
std::vector<std::string> csv_cells(const TableLines& line);

/// A CSV file whose header is given: rows of as many cells, with the place of each.
struct CsvRow {
  SourcePlace place;
  std::vector<std::string> cells;
};
/// Throws InputError for another header, rows of another length and a file without rows.
std::vector<CsvRow> csv_rows(const TableFile& file, std::string_view header);
/// Cell as a finite number. Throws InputError.
double csv_number(const CsvRow& row, std::size_t column, std::string_view name);

/// Throws InputError where `position` does not lie beyond the last one.
void require_ascending(const std::vector<double>& positions, double position, const SourcePlace& place);

}  // namespace volcal
