#pragma once
/// A truth machine seen in the datum of error tables: every function zero at home, straightness without its
/// least-squares slope, the slopes in squareness and in the rotation of the machine frame. m and rad.
///
/// The slope is the continuous, uniformly weighted one over the travel, 12/L^3 int (q - centre) f dq, by
/// Gauss-Legendre quadrature; smooth functions are integrated to rounding (tested to 1e-12 relative).
/// Of the six slopes three become squareness and three rotate the frame: both of the primary axis and, of the
/// secondary axis, the one about the primary direction. Functional points in the datum differ from the truth
/// machine's by a rigid motion and, where the frame is rotated by phi or an angle is not zero at home, by a
/// constant phi x offset per tool; to second order in the errors.

#include <Eigen/Core>
#include <array>

#include "volcal/sim/machine/truth_machine.h"

namespace volcal::sim {

/// Least-squares slope of `function` over [low, high], uniformly weighted.
double least_squares_slope(const ErrorFunction& function, double low, double high);

/// Linear axes only: asking for a symbol of a rotary axis throws std::invalid_argument.
class TruthInDatum {
 public:
  /// The machine's own datum, or another. The three linear axes must be present.
  explicit TruthInDatum(const TruthMachine& truth);
  TruthInDatum(const TruthMachine& truth, Datum datum);

  const Datum& datum() const { return datum_; }
  /// Error function at a position, mean of both directions.
  double value(ErrorSymbol symbol, double position) const;
  /// In the order of Datum::squareness(), rad.
  const std::array<double, 3>& squareness() const { return squareness_; }
  /// Slope moved out of a straightness function, rad; 0 for other symbols.
  double removed_slope(ErrorSymbol symbol) const;
  /// Rotation of the datum's machine frame against the truth machine's, rad.
  const Eigen::Vector3d& frame_rotation() const { return frame_rotation_; }

 private:
  Eigen::Vector3d direction_error(AxisName axis) const;

  TruthMachine truth_;
  Datum datum_;
  std::array<std::array<double, 3>, 3> slope_{};  ///< [axis][component]
  std::array<double, 3> squareness_{};
  Eigen::Vector3d frame_rotation_ = Eigen::Vector3d::Zero();
};

}  // namespace volcal::sim
