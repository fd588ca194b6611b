#pragma once
/// Tolerances of a machine that is not built yet: widths of the bands within which its errors may lie. Plain
/// data, SI units.

#include <map>
#include <string>

#include "volcal/model/description/symbols.h"

namespace volcal {

struct Tolerances {
  std::string file;
  std::map<ErrorSymbol, double> functions;      ///< of an error motion over the travel, m or rad
  std::map<LocationSymbol, double> squareness;  ///< rad
};

}  // namespace volcal
