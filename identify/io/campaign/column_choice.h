#pragma once
/// Which columns of a readings file are read, under which standard names, and what the others may be meant to
/// be.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/text/csv_table.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/description/schema.h"

namespace volcal {

/// How a setup's file departs from the standard names and units (keys `columns`, `scale` and `constants`).
struct ColumnMapping {
  std::map<std::string, std::string> file_name;  ///< standard name -> name in the file
  std::map<std::string, double> scale;           ///< standard name -> factor from the file to the name's unit
  std::map<std::string, double> constant;        ///< standard name -> value of every row, in the name's unit
  SourcePlace place;                             ///< of `columns`, for messages
  SourcePlace scale_place;
  SourcePlace constant_place;
};

/// A column that nobody reads; `meant`: the standard column that its name resembles, empty = none.
struct UnusedColumn {
  std::string name;
  std::string meant;
};

struct ColumnChoice {
  std::size_t column_set = 0;      ///< which of the instrument's column sets was found
  std::vector<std::string> name;   ///< standard names of the columns taken
  std::vector<std::size_t> index;  ///< in the header of the file, in step with `name`
  std::vector<UnusedColumn> unused;
};

/// Columns that a file may lack, in the order in which they are looked for.
std::vector<std::string> optional_columns(const Machine& machine, const InstrumentSchema& instrument);

/// Standard column names that a setup of this machine and instrument understands; temperatures,
/// T_<channel>_degC, come on top.
std::vector<std::string> known_columns(const Machine& machine, const InstrumentSchema& instrument);

/// Throws InputError: columns that are missing, repeated, ambiguous or mapped twice, and those that are a
/// slip of a standard name.
ColumnChoice choose_columns(const CsvTable& table, const ColumnMapping& mapping, const Machine& machine,
                            const InstrumentSchema& instrument);

}  // namespace volcal
