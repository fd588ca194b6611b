#pragma once
/// Table formats: an identified machine as the files that a program or a controller reads. A new format is
/// one file that defines a `TableFormat` and one line in table_formats.cpp; the command line, its help and
/// the contract tests follow from the registration.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "volcal/identify/tables/error_tables.h"

namespace volcal {

struct TableFile {
  std::string name;  ///< no folder in it
  std::string content;
};

struct TableFormatOptions {
  ErrorTableOptions functions;
  int grid_per_axis = 5;  ///< positions per axis where a format holds volumetric errors
};

struct TableFormat {
  std::string_view name;     ///< as the user writes it: "csv"
  std::string_view summary;  ///< one sentence for the user
  std::string_view source;   ///< which document fixes the format
  /// Content of every file, errors as actual minus nominal turned into what the format holds. The same result
  /// gives the same bytes. Throws InputError for a result that the format cannot hold.
  std::vector<TableFile> (*write)(const FitResult& result, const TableFormatOptions& options);
};

std::span<const TableFormat* const> table_formats();
const TableFormat* find_table_format(std::string_view name);  ///< nullptr when unknown
std::vector<std::string> table_format_names();

}  // namespace volcal
