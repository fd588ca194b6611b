#pragma once
/// What curves and surfaces that have faded out at the stated conditions may still be, over a volume.

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "volcal/identify/errors/error_field.h"

namespace volcal {

/// Mean squares of displacements, m^2. A curve by conditions alone, as by a temperature, is as large at every
/// point: one error, of which the best rigid motion is taken away, as a frame's alignment does. Of a surface
/// that depends on a position nothing tells how it goes on from point to point: it counts as it is.
class FadedInVolume {
 public:
  /// `errors`: of all curves and surfaces at the point (ErrorField::faded_errors()). `place`: m, workpiece
  /// coordinates.
  void add(const Eigen::Vector3d& place, std::span<const FadedError> errors);

  double mean_square() const;
  /// Of those whose first coefficient is among `parameters`.
  double mean_square(std::span<const int> parameters) const;
  /// Of each of them.
  std::vector<double> mean_squares(std::span<const int> parameters) const;

 private:
  struct Surface {
    std::vector<Eigen::Vector3d> places, errors;
    double least = 0.0, most = 0.0;
  };
  double mean_square_of(const Surface& surface) const;

  std::map<int, Surface> surfaces_;  ///< by first coefficient
  std::size_t points_ = 0;
};

}  // namespace volcal
