#pragma once
/// Circular tests, ISO 230-4:2005, clause 3, from a ball-bar: radius at commanded angles, counter-clockwise
/// and clockwise. Lengths in m, angles in rad from the first axis of the plane to the second.
///
///   circular deviation G(CCW), G(CW): radial range of one path about its least-squares circle
///   bidirectional circular deviation G(b): radial range of both paths about their common least-squares
///   circle radial deviation F: actual radius minus nominal radius, positive outwards; Fmax, Fmin. Centre:
///   the path's
///     least-squares centre when it is a full circle, else the centring of the instrument (3.6 a and b)
///   mean bidirectional radial deviation D: radius of the common least-squares circle minus nominal radius
///
/// The bar measures the distance from its own centre to a point that the machine was sent to, so the circle
/// is |R u(angle) - centre|, fitted exactly, not to first order in the centre.
///
/// Reversal at a quadrant point: an axis turns round where the path crosses it. The step of the radius is
/// read between straight lines through the readings within 20 degrees on either side, and given as ISO
/// 230-2's B = x+ - x- of that axis: an outward step (lost motion) is a negative B.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace volcal {

struct CircleReading {
  double angle = 0.0;      ///< commanded, rad
  double deviation = 0.0;  ///< measured distance to the instrument's centre minus the nominal radius, m
  int sense = 0;           ///< +1 counter-clockwise (first axis towards second), -1 clockwise
};

enum class Centring { LeastSquares, Instrument };

struct CircularPath {
  int readings = 0;
  double circular_deviation = 0.0;                   ///< G
  double radial_max = 0.0;                           ///< Fmax
  double radial_min = 0.0;                           ///< Fmin
  Centring centring = Centring::LeastSquares;        ///< of Fmax and Fmin
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< least-squares centre in the plane
  double largest_gap = 0.0;                          ///< between neighbouring readings, rad
};

struct QuadrantReversal {
  int axis = 0;        ///< 0 first, 1 second axis of the plane
  int side = +1;       ///< end of the axis at which it turns round
  int sense = +1;      ///< of the path
  double value = 0.0;  ///< x+ - x- of that axis
};

struct CircularFigures {
  /// Of one axis of the circle, 0 or 1, mean over both ends and senses; none: not read.
  std::optional<double> mean_reversal(int axis) const;

  std::optional<CircularPath> counter_clockwise;
  std::optional<CircularPath> clockwise;
  std::optional<double> bidirectional;  ///< G(b)
  std::optional<double> mean_radial;    ///< D
  std::vector<QuadrantReversal> reversals;
  /// Centre about which both senses are drawn together: the least-squares centre of all readings where they
  /// are full circles, else the instrument's.
  Centring centring = Centring::Instrument;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
};

/// `instrument_centre`: offset of the instrument's centre from the commanded circle's as set up, m. A path
/// with fewer than four readings, or on which the circle is not determined, is left empty. Readings of sense
/// 0 are not used.
CircularFigures circular_figures(std::span<const CircleReading> readings, double nominal_radius,
                                 const Eigen::Vector2d& instrument_centre = Eigen::Vector2d::Zero());

/// The readings with their radial deviations F about a centre, whatever the path's own would be.
std::vector<CircleReading> radial_deviations(std::span<const CircleReading> readings, double nominal_radius,
                                             const Eigen::Vector2d& centre);

}  // namespace volcal
