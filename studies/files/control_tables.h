#pragma once
/// Folders of table files: which format they have, and the files as the simulated control
/// (sim/machine/control.h) takes them. The format's own reader says whether the files are right; what they
/// mean is then read a second time from the controllers' documents, apart from it: values as they stand in
/// the file, with the sign that the control gives them.

#include <span>
#include <string>
#include <vector>

#include "volcal/identify/compensation/table_format.h"
#include "volcal/sim/machine/control.h"

namespace volcal {

struct TablesFolder {
  const TableFormat* format = nullptr;
  std::vector<TableFile> files;
};

/// Format by the names of the files. Throws InputError for a folder without tables.
TablesFolder read_tables_folder(const std::string& folder);

/// Whether the simulated control reads a format: one function and one line of control_tables.cpp.
bool control_reads(const TableFormat& format);

/// Throws InputError with file, line and remedy for files that the format does not allow, and for a format
/// that the simulated control does not read.
sim::ControlTables control_tables(const TableFormat& format, std::span<const TableFile> files);

}  // namespace volcal
