#include "volcal/identify/io/campaign/reading_columns.h"

#include <algorithm>
#include <string_view>

#include "volcal/model/description/units.h"
#include "volcal/model/description/variable.h"

namespace volcal {

std::string axis_column(AxisName axis) { return position_column(axis); }

std::string direction_column(AxisName axis) { return direction_of_approach(axis).column(); }

std::string sigma_column(const InstrumentSchema& instrument) {
  const auto is_angle = [](const ColumnSchema& column) {
    const std::string_view unit = unit_of_key(column.column).suffix;
    return unit == "urad" || unit == "deg" || unit == "rad" || unit == "mrad";
  };
  const auto angles_only = [&](const auto& set) { return std::ranges::all_of(set, is_angle); };
  return std::ranges::all_of(instrument.column_sets, angles_only) ? "sigma_urad" : "sigma_um";
}

std::string temperature_channel(const std::string& column) {
  const auto variable = Variable::parse_column(column);
  return variable && variable->kind == Variable::Kind::Temperature ? variable->subject : "";
}

}  // namespace volcal
