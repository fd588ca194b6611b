#pragma once
/// Where the average lines of identified rotary axes lie, with uncertainty.

#include <Eigen/Core>
#include <array>
#include <vector>

#include "volcal/identify/errors/rotary/rotary_axes.h"

namespace volcal {

/// Errors of an axis average line at machine zero (rotary_axes.h), machine frame.
struct IdentifiedLine {
  AxisName axis = AxisName::C;
  AxisLineErrors value;
  /// Of displacement (m) and rotation (rad), 6 x 6.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  /// Of displacement and rotation: zero since no identified error of this axis or of one that carries it
  /// enters. What cannot be told from other errors is so by convention, the place of the workpiece included
  /// (independent_locations()).
  std::array<bool, 6> by_convention = {};

  /// Displacement of the line, `along` m from the nominal centre in the axis' direction: d + along alpha x u.
  Eigen::Vector3d displacement_at(double along) const;
  /// Its covariance, m^2.
  Eigen::Matrix3d covariance_at(double along) const;
};

/// Lines of the rotary axes with identified location errors, A B C.
std::vector<IdentifiedLine> identified_lines(const FitResult& result);

}  // namespace volcal
