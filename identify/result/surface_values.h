#pragma once
/// Surfaces of an identified model (effects of the kind `empirical`) as functions: coefficients alone tell
/// nobody anything.

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "volcal/identify/result/result.h"
#include "volcal/model/description/variable.h"
#include "volcal/model/effects/effect.h"

namespace volcal {

/// SI but for places, which are in the units of their drivers.
struct SurfaceValues {
  std::shared_ptr<const Effect> effect;
  std::string label;   ///< "surface EAY by y z"
  std::string target;  ///< "EAY"
  std::string factor;  ///< variables that it is multiplied with: "dir_x"; empty = none
  std::vector<Variable> drivers;
  std::string unit;  ///< edge
  double si_per_unit = 1.0;
  int offset = 0;               ///< of its coefficients in FitResult::parameters
  double rms = 0.0;             ///< over the range of the drivers
  double largest = 0.0;         ///< of the largest magnitude (largest_value.h)
  double largest_u = 0.0;       ///< standard uncertainty
  Eigen::VectorXd largest_row;  ///< its derivatives to the coefficients
  std::vector<double> at;       ///< its place, one value per driver

  /// "y = 310 mm, z = -120 mm", where it is largest.
  std::string place_words() const;
};

/// In the order of the model's effects.
std::vector<SurfaceValues> surface_values(const FitResult& result);

/// Standard uncertainties of values with these derivatives to the coefficients, a row each.
Eigen::VectorXd uncertainty_of_values(const FitResult& result, const SurfaceValues& surface,
                                      const Eigen::MatrixXd& rows);

}  // namespace volcal
