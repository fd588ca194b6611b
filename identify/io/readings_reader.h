#pragma once
/// Readings of one setup out of a CSV file: which columns there are, what they are called in this file, their
/// units and plausible ranges.

#include <map>
#include <string>

#include "volcal/identify/io/csv_table.h"
#include "volcal/identify/io/reading_columns.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/description/schema.h"

namespace volcal {

/// How a setup's file departs from the standard names and units (keys `columns` and `scale`).
struct ColumnMapping {
  std::map<std::string, std::string> file_name;  ///< standard name -> name in the file
  std::map<std::string, double> scale;           ///< standard name -> factor from the file to the name's unit
  SourcePlace place;                             ///< of `columns`, for messages
  SourcePlace scale_place;
};

/// Standard column names that a setup of this machine and instrument understands; temperatures,
/// T_<channel>_degC, come on top.
std::vector<std::string> known_columns(const Machine& machine, const InstrumentSchema& instrument);

/// Converts the file to SI. Throws InputError: missing, repeated or ambiguous columns, positions more than 5
/// % outside the travel, implausible readings, temperatures all outside -20 to 60 degC,
/// directions other than -1, 0, 1, line numbers that are no
/// integers.
Readings read_readings(const CsvTable& table, const ColumnMapping& mapping, const Machine& machine,
                       const InstrumentSchema& instrument);

}  // namespace volcal
