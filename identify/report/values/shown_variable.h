#pragma once
/// How a recorded variable is called and in which unit it is shown.

#include <string>

#include "volcal/model/description/variable.h"

namespace volcal::report {

struct ShownVariable {
  std::string title;
  std::string unit;     ///< edge
  double factor = 1.0;  ///< edge value = factor x SI value
};

/// Time in min, all else in the unit in which users write of it.
ShownVariable shown_variable(const Variable& variable);
/// That unit: "mm", "°C", "mm/min"; empty for what has none.
std::string shown_unit_of(const Variable& variable);
/// By the name of a variable, or of what groups readings: "setup", "station", "tool".
ShownVariable shown_variable(const std::string& name);

}  // namespace volcal::report
