#pragma once
/// Readings of one setup out of a CSV file: which columns there are, what they are called in this file, their
/// units and plausible ranges.

#include "volcal/identify/io/campaign/column_choice.h"
#include "volcal/identify/io/campaign/reading_columns.h"
#include "volcal/identify/text/csv_table.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/machine.h"
#include "volcal/model/description/schema.h"

namespace volcal {

/// Converts the file to SI. Throws InputError: missing, repeated or ambiguous columns, positions more than 5
/// % outside the travel, implausible readings, temperatures all outside -20 to 60 degC,
/// directions other than -1, 0, 1, line numbers that are no
/// integers.
Readings read_readings(const CsvTable& table, const ColumnMapping& mapping, const ColumnChoice& choice,
                       const Machine& machine, const InstrumentSchema& instrument);
/// The same with the columns that choose_columns() takes.
Readings read_readings(const CsvTable& table, const ColumnMapping& mapping, const Machine& machine,
                       const InstrumentSchema& instrument);

}  // namespace volcal
