#pragma once
/// LINEAR_UNITS of LinuxCNC, which the numbers of its files have.

#include <array>
#include <string>
#include <string_view>

#include "volcal/identify/compensation/table_format.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {

inline constexpr std::array<TableSetting, 1> kLinuxCncSettings = {
    {{"units", "LINEAR_UNITS of the machine's INI file, mm or inch", "mm", "inch"}}};

/// In m; 0 when it is neither mm nor inch.
inline double linear_unit(std::string_view name) {
  if (name == "mm") return kMetrePerMillimetre;
  return name == "inch" ? kMetrePerInch : 0.0;
}

/// The setting, mm or inch. Throws InputError for another.
inline std::string linear_units_of(const TableFormatOptions& options) {
  std::string units = table_setting(kLinuxCncSettings, options, "units");
  if (linear_unit(units) == 0.0) throw InputError({}, "--set units=" + units, "write units=mm or units=inch");
  return units;
}

}  // namespace volcal
