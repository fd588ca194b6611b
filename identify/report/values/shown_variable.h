#pragma once
/// How a recorded variable is called and in which unit it is shown.

#include <string>

namespace volcal::report {

struct ShownVariable {
  std::string title;
  std::string unit;     ///< edge
  double factor = 1.0;  ///< edge value = factor x SI value
};

/// Of a variable of the scans by its name in files: "x", "dir_x", "T_air", "time".
ShownVariable shown_variable(const std::string& name);

}  // namespace volcal::report
