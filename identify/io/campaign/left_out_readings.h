#pragma once
/// Readings that are known to be wrong and that a setup names with the reason (key `leave_out`):
///
///   leave_out = [{ rows = [8, 9], columns = ["ez_um"], reason = "beam interrupted" }]
///
/// `rows` are lines of the data file, its header included, as in the column `row` of residuals.csv; without
/// `columns` every reading of these rows is left out. What stands in the file must still be a plausible
/// number.

#include <string>
#include <vector>

#include "volcal/identify/text/toml_document.h"
#include "volcal/model/description/campaign.h"

namespace volcal {

/// One entry of `leave_out`.
struct LeaveOut {
  std::vector<double> rows;
  std::vector<std::string> columns;
  std::string reason;
  SourcePlace rows_place;
  SourcePlace columns_place;
};

/// Throws InputError for an entry without rows or reason.
std::vector<LeaveOut> read_leave_out(const TomlTable& setup);

/// The readings named, in the order of the file. Throws InputError for a row that holds no reading, a column
/// that the setup does not read, a reading named twice, and when no reading of the setup is kept.
std::vector<LeftOutReading> left_out_readings(const std::vector<LeaveOut>& entries, const Setup& setup);

}  // namespace volcal
