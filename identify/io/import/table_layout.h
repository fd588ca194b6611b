#pragma once
/// How a text file of unknown origin is laid out as a table: what separates its cells, its decimal sign,
/// which line is the header, which columns hold numbers.

#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/io/import/import_format.h"
#include "volcal/identify/io/import/import_lines.h"

namespace volcal {

struct TableRow {
  int line = 0;
  std::vector<std::string> cells;
};

struct TableLayout {
  char delimiter = ',';  ///< ' ' = any blanks
  char decimal = '.';
  int header_line = 0;              ///< 0 = there is none
  std::vector<std::string> header;  ///< as many as columns, or none; with a row of units in brackets
  std::vector<bool> numeric;        ///< by column
  std::vector<TableRow> rows;       ///< all with the same number of cells
  std::vector<TextLine> above;      ///< lines above the rows that are not the header, and comments

  double number(const TableRow& row, std::size_t column) const;
};

/// Lines that begin with #, // or ! are comments. `source` must outlive the layout. Throws InputError: no
/// table, a row with other cells than the others, text where the column has numbers, a decimal sign that
/// stays open (SeenSigns).
TableLayout guess_table_layout(const ImportSource& source);

/// Whether half of the cells of two rows or more are numbers: what cannot be read of such a text is said with
/// its line.
bool resembles_table(const ImportSource& source);

/// "3 lines, first "..."" of what stands beside the header and the rows; empty = nothing.
std::string lines_beside(const TableLayout& layout);

/// The word for a delimiter, and the text that stands for it in messages.
std::string delimiter_name(char delimiter);

}  // namespace volcal
