#pragma once
/// Axis of rotation, ISO 230-7:2006: values of the error motion of a rotary axis from displacements at known
/// angles, over one or more full turns. m or rad; angles in rad.
///
///   total error motion value         difference in radii of two concentric circles, about the error motion
///                                    centre, that just contain the error motion polar plot
///   synchronous error motion value   the same for the plot of the mean over the turns at every angle
///   asynchronous error motion value  largest width of the plot at one angle, as the turns differ
///   fundamental error motion         twice the amplitude of the component at one wave a turn
///
/// Centres: of radial and tilt error motion the least-squares circle's, which takes out the eccentricity of
/// the sphere or the inclination of the mandrel (one wave a turn); of axial error motion the centre of the
/// polar chart, where one wave a turn is an error of the axis. To first order in deviation over radius the
/// difference in radii about the least-squares centre is the range of what is left by a least-squares
/// constant, cosine and sine.
///
/// The text of the standard was not at hand: the definitions are those in common use under its name.

#include <optional>
#include <span>
#include <vector>

namespace volcal {

struct RotationReading {
  double angle = 0.0;  ///< commanded; turns count on, or not
  double value = 0.0;  ///< displacement or tilt, m or rad
};

enum class MotionCentre { LeastSquares, PolarChart };

/// What the readings do not define is empty: values need a full turn, the asynchronous one an angle that was
/// met twice.
struct ErrorMotionFigures {
  int angles = 0;            ///< different angles of a turn
  double largest_gap = 0.0;  ///< between neighbouring angles, rad
  std::optional<double> total;
  std::optional<double> synchronous;
  std::optional<double> asynchronous;
  std::optional<double> fundamental;
};

/// Neighbouring angles of a full turn are at most this far apart, rad (a decision: eight places a turn).
inline constexpr double kLargestAngleGap = 46.0 * 3.14159265358979323846 / 180.0;

ErrorMotionFigures error_motion_figures(std::span<const RotationReading> readings, MotionCentre centre);

/// What the plot shows: readings about their least-squares constant and, about the least-squares centre of a
/// full turn, without one wave a turn.
std::vector<RotationReading> about_centre(std::span<const RotationReading> readings, MotionCentre centre);

}  // namespace volcal
