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

ShownVariable shown_variable(const Variable& variable);
/// By the name of a variable, or of what groups readings: "setup", "station", "tool".
ShownVariable shown_variable(const std::string& name);

}  // namespace volcal::report
