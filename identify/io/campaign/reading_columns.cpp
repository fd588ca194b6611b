#include "volcal/identify/io/campaign/reading_columns.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "volcal/model/description/units.h"

namespace volcal {

std::string axis_column(AxisName axis) { return position_column(axis); }

std::string direction_column(AxisName axis) {
  const char letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter_of(axis))));
  return std::string("dir_") + letter;
}

std::string sigma_column(const InstrumentSchema& instrument) {
  const auto is_angle = [](const ColumnSchema& column) {
    const std::string_view unit = unit_of_key(column.column).suffix;
    return unit == "urad" || unit == "deg" || unit == "rad" || unit == "mrad";
  };
  const auto angles_only = [&](const auto& set) { return std::ranges::all_of(set, is_angle); };
  return std::ranges::all_of(instrument.column_sets, angles_only) ? "sigma_urad" : "sigma_um";
}

std::string temperature_channel(const std::string& column) {
  constexpr std::string_view kPrefix = "T_";
  constexpr std::string_view kSuffix = "_degC";
  const bool fits = column.size() > kPrefix.size() + kSuffix.size() && column.starts_with(kPrefix) &&
                    column.ends_with(kSuffix);
  return fits ? column.substr(kPrefix.size(), column.size() - kPrefix.size() - kSuffix.size()) : "";
}

}  // namespace volcal
