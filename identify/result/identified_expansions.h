#pragma once
/// Expansions of scales as an identification found them.

#include <string>
#include <vector>

#include "volcal/identify/result/result.h"

namespace volcal {

/// Coefficient of expansion of the scale of an axis, 1/K.
struct IdentifiedExpansion {
  AxisName axis = AxisName::X;
  std::string channel;      ///< its temperature
  double stated = 0.0;      ///< by the machine file
  double stated_u = 0.0;    ///< standard uncertainty; 0 = the machine file calls it exact
  double per_kelvin = 0.0;  ///< identified
  double u = 0.0;           ///< standard uncertainty
};

/// Of the axes whose coefficient is another than the machine file's, or was estimated; in the machine's
/// order.
std::vector<IdentifiedExpansion> identified_expansions(const FitResult& result);

}  // namespace volcal
