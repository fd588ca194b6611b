#pragma once
/// Surfaces of an identified model (effects of the kind `empirical`) as functions: coefficients alone tell
/// nobody anything.

#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/variable.h"

namespace volcal::report {

struct SurfaceValues {
  std::string label;  ///< "surface EAY by y z"
  std::vector<Variable> drivers;
  std::string unit;  ///< edge
  double si_per_unit = 1.0;
  double rms = 0.0;      ///< SI, over the range of the drivers
  double largest = 0.0;  ///< SI, of the largest magnitude
  double largest_u = 0.0;
  std::vector<double> at;  ///< there, one value per driver, in its unit
};

std::vector<SurfaceValues> surface_values(const FitResult& result);

/// "surface EAY by y z: up to 12.3 +- 0.8 urad at y = 310, z = -120"
std::string surface_line(const SurfaceValues& surface, double coverage_factor);

}  // namespace volcal::report
