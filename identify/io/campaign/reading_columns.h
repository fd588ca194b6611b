#pragma once
/// Standard names of the columns of readings files.

#include <string>

#include "volcal/model/description/schema.h"
#include "volcal/model/description/symbols.h"

namespace volcal {

/// Column of the commanded position of an axis: "x_mm", "a_deg".
std::string axis_column(AxisName axis);
/// Column of the direction of approach of an axis: "dir_x".
std::string direction_column(AxisName axis);
/// "sigma_um", or "sigma_urad" when every reading of the instrument is an angle.
std::string sigma_column(const InstrumentSchema& instrument);
/// Channel of a temperature column name T_<channel>_degC; empty for other names.
std::string temperature_channel(const std::string& column);

}  // namespace volcal
