#pragma once
/// A truth machine seen in the datum of error tables: every function of a linear axis zero at home,
/// straightness without its least-squares slope, the slopes in squareness and in the rotation of the machine
/// frame; of a rotary axis the constant part in its location errors. m and rad.
///
/// The slope is the continuous, uniformly weighted one over the travel, 12/L^3 int (q - centre) f dq, by
/// Gauss-Legendre quadrature; smooth functions are integrated to rounding (tested to 1e-12 relative).
/// Of the six slopes of X, Y, Z three become squareness and three rotate the frame: both of the primary axis
/// and, of the secondary axis, the one about the primary direction. Those of U, V, W become their angles.
/// Functional points in the datum differ from the truth machine's by a rigid motion and, where the frame is
/// rotated by phi or an angle is not zero at home, by a constant phi x offset per tool; to second order in
/// the errors.
///
/// Rotary axes. The four transverse error motions (EXC, EYC, EAC, EBC) have zero mean over the travel,
/// uniformly weighted; displacement along the axis (EZC) and positioning (ECC) are zero at home. What is
/// taken out is in the location error: a constant EXC = c equals EX0C = s c, s = +1 on the tool side and -1
/// on the workpiece side; a constant ECC = c equals EC0C = c on both. What the linear axes' home values and
/// the rotation of the machine frame do to a rotary axis is in the location errors of the rotary axis nearest
/// the bed on each side. All six location errors are given, the displacement along the axis (EZ0C) too. Not
/// taken out is the first harmonic of a transverse pair, which the next body outward could hold as well: what
/// a fit calls EAC may differ from this by such a harmonic, and its location errors by combinations that no
/// reading sees. To first order in the errors; of a structure with a linear axis outward of a rotary one the
/// location errors count from the truth machine's own frame, which is exact where frame_rotation() and the
/// linear axes' home values are zero, as they are in random truths.

#include <Eigen/Core>
#include <array>
#include <map>

#include "volcal/sim/machine/truth_machine.h"

namespace volcal::sim {

/// Least-squares slope of `function` over [low, high], uniformly weighted.
double least_squares_slope(const ErrorFunction& function, double low, double high);

/// Mean of `function` over [low, high], uniformly weighted; quadrature as above.
double uniform_mean(const ErrorFunction& function, double low, double high);

class TruthInDatum {
 public:
  /// The machine's own datum, or another. Both axes of the datum must be present.
  explicit TruthInDatum(const TruthMachine& truth);
  TruthInDatum(const TruthMachine& truth, Datum datum);

  const Datum& datum() const { return datum_; }
  /// Error function at a position, mean of both directions.
  double value(ErrorSymbol symbol, double position) const;
  /// In the order of Datum::squareness(), rad.
  const std::array<double, 3>& squareness() const { return squareness_; }
  /// Location error of a rotary axis, its own rotation being the zero position, or angle of U, V or W. Throws
  /// std::invalid_argument for X, Y, Z.
  double location(LocationSymbol symbol) const;
  /// Slope moved out of a straightness function, rad; 0 for other symbols.
  double removed_slope(ErrorSymbol symbol) const;
  /// Rotation of the datum's machine frame against the truth machine's, rad.
  const Eigen::Vector3d& frame_rotation() const { return frame_rotation_; }

 private:
  /// Constant that leaves a function for the datum.
  double removed_constant(ErrorSymbol symbol) const;
  Eigen::Vector3d direction_error(AxisName axis) const;
  void find_slopes(const Axis& axis);
  void set_locations();
  void set_angles_of_parallel_axes();
  void carry_linear_constants();

  TruthMachine truth_;
  Datum datum_;
  std::array<std::array<double, 3>, kAxisCount> slope_{};  ///< [axis][component], of linear axes
  std::array<double, 3> squareness_{};
  Eigen::Vector3d frame_rotation_ = Eigen::Vector3d::Zero();
  std::map<ErrorSymbol, double> mean_;  ///< of transverse error motions of rotary axes
  std::map<LocationSymbol, double> locations_;
};

}  // namespace volcal::sim
