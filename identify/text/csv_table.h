#pragma once
/// CSV files of numbers, as instruments write them.
///
/// The header row is required and gives the column names; columns may stand in any order. Fields may be
/// quoted, lines may end in CRLF, lines that start with '#' and blank lines are skipped, and a byte order
/// mark is ignored. Line numbers are those of the file, 1-based. Only the columns asked for are converted, so
/// that others may hold text. About 500 MB/s on one core; memory is the file plus 8 bytes per converted cell.
/// Errors (InputError) name file, line and column: too few or too many cells, empty cells, text where a
/// number is expected, nan, inf, no rows, the wrong decimal sign or delimiter with the key that mends it.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/text/text_encoding.h"
#include "volcal/model/description/errors.h"

namespace volcal {

struct CsvFormat {
  char delimiter = ',';
  char decimal = '.';
  TextEncoding encoding = TextEncoding::Utf8;
  std::size_t skip_rows = 0;               ///< lines of the file before the header is looked for
  bool encoding_only_if_not_utf8 = false;  ///< of a file that is UTF-8 `encoding` says nothing
};

/// A column of numbers in memory, in the unit of its name.
struct NumberColumn {
  std::string name;
  std::span<const double> values;
};

struct CsvColumns {
  std::vector<std::vector<double>> values;  ///< [asked column][row], in the unit of the file
  std::vector<std::int64_t> source_line;    ///< [row], 1-based

  std::size_t size() const { return source_line.size(); }
};

class CsvTable {
 public:
  /// Reads file and header. `named_at`: line of the file that names this one.
  static CsvTable read(const std::string& path, const CsvFormat& format, const SourcePlace& named_at = {});
  static CsvTable parse(std::string text, const std::string& file, const CsvFormat& format);

  /// Columns in memory in place of a file; rows count from 1, or stood in `lines` of a file. What they refer
  /// to must outlive the table. Throws InputError for columns of different length and where there is none or
  /// no row.
  static CsvTable of_columns(std::vector<NumberColumn> columns, const std::string& name,
                             std::vector<std::int64_t> lines = {});

  const std::string& file() const { return file_; }
  const std::vector<std::string>& header() const { return header_; }
  SourcePlace header_place() const { return {file_, static_cast<int>(header_line_)}; }
  /// Index of a column; throws when the name appears twice.
  std::optional<std::size_t> find(std::string_view name) const;
  /// Delimiter that the header seems to use when it is not the one of the format.
  std::optional<char> other_delimiter() const;
  /// Converts the asked columns (indices into the header) of all rows.
  CsvColumns numbers(std::span<const std::size_t> columns) const;

 private:
  CsvTable() = default;
  CsvTable(std::string text, std::string file, const CsvFormat& format);
  CsvColumns numbers_in_memory(std::span<const std::size_t> columns) const;

  class RowReader;

  std::string text_;
  std::string file_;
  CsvFormat format_;
  std::vector<std::string> header_;
  std::int64_t header_line_ = 0;
  std::size_t body_ = 0;  ///< offset of the first byte after the header
  std::vector<NumberColumn> in_memory_;
  std::vector<std::int64_t> lines_;  ///< of the rows in memory, from 1 where there are none
};

}  // namespace volcal
