#include "volcal/identify/compensation/active_tables.h"

#include <map>

#include "volcal/identify/compensation/csv_tables.h"

namespace volcal {

Correction ActiveTables::correction(const AxisPosition& position, const ApproachDirection& direction) const {
  Correction sum = tables.correction(position, direction);
  if (!former) return sum;
  const Correction before = former->correction(position, direction);
  sum.linear -= before.linear;
  sum.rotary -= before.rotary;
  return sum;
}

bool stand_beside(const TableFile& metadata, const std::string& active_compensations) {
  const std::map<std::string, std::string> entries = read_table_metadata(metadata).entries;
  const auto says = [&](const std::string& key, const std::string& value) {
    const auto found = entries.find(key);
    return found != entries.end() && found->second == value;
  };
  return says(std::string(kSuperimposedOn), std::string(kSuperimposedOnNone)) &&
         says("active_compensations", active_compensations);
}

}  // namespace volcal
