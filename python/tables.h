#pragma once
/// Tables with those that they stand in place of.

#include <memory>
#include <string>

#include "volcal/identify/compensation/active_tables.h"
#include "volcal/identify/compensation/checks/made_tables.h"

namespace volcal::python {

struct Tables {
  MadeTables made;
  std::shared_ptr<const Tables> former;  ///< that they are superimposed on; null = none
  std::string active_compensations;      ///< while the errors were identified that they were made from
};

/// Of a compensated machine that is judged by errors identified with these compensations.
ActiveTables active_tables_of(const Tables& tables, const std::string& identified_with);

}  // namespace volcal::python
