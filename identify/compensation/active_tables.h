#pragma once
/// Tables that were active while a campaign was measured, for a judgement by the errors that they were made
/// from (ISO/TR 16907:2015, 11.3).

#include <optional>
#include <string>

#include "volcal/identify/compensation/compensation_tables.h"
#include "volcal/identify/compensation/table_format.h"

namespace volcal {

struct ActiveTables {
  CompensationTables tables;
  /// That were active while the errors were identified, and that `tables` stand in place of.
  std::optional<CompensationTables> former;
  /// Nothing says whether the tables stand in place of what was active while the errors were identified.
  bool is_doubtful = false;

  /// What the tables correct of the machine that was identified.
  Correction correction(const AxisPosition& position, const ApproachDirection& direction) const;
};

/// Whether metadata.csv says that its tables are superimposed on none and made from errors that were
/// identified with these compensations.
bool stand_beside(const TableFile& metadata, const std::string& active_compensations);

}  // namespace volcal
