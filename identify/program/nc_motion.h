#pragma once
/// Motions that blocks ask for, as positions of the axes X, Y and Z in machine coordinates, m and s.

#include <Eigen/Core>
#include <limits>

namespace volcal {

/// Plane of arcs: the axes of its first and second coordinate, and the one across. A positive turn takes the
/// first towards the second (ISO 841): G17 XY, G18 ZX, G19 YZ.
struct NcPlane {
  int first = 0;
  int second = 1;
  int across = 2;

  /// 170, 180 or 190.
  static NcPlane of_code(int tenths);
};

/// Circular arc or helix; its radius changes linearly with the angle where the end points ask for it.
struct NcArc {
  NcPlane plane;
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< in the plane
  double start_angle = 0.0;                          ///< from the first axis, rad
  double sweep = 0.0;                                ///< positive counter-clockwise, rad
  double start_radius = 0.0;
  double end_radius = 0.0;

  /// t = 0..1 along the angle; start and end exactly.
  Eigen::Vector3d point(double t) const;
  /// Derivative of point() by t, m.
  Eigen::Vector3d tangent(double t) const;
  double length() const;
};

/// What an arc block says: end point (of the whole block), centre or radius, turns. Machine coordinates, m.
struct NcArcWords {
  NcPlane plane;
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  bool clockwise = false;
  int turns = 1;  ///< P: 1 for up to a full circle, 2 for up to two
};

/// Radii at both ends may differ by this much, m, or by a thousandth.
inline constexpr double kArcRadiusTolerance = 5e-6;

/// Arc about a centre in the plane. Throws std::invalid_argument, in words, for radii that differ or vanish.
NcArc arc_about(const NcArcWords& words, const Eigen::Vector2d& centre);
/// Arc of a radius: the shorter way where it is positive, the longer way where negative. Throws
/// std::invalid_argument where no such arc exists.
NcArc arc_of_radius(const NcArcWords& words, double radius);

enum class NcMotionKind { Rapid, Feed, Arc, Dwell };

struct NcMotion {
  NcMotionKind kind = NcMotionKind::Rapid;
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
  NcArc arc;  ///< of kind Arc
  /// Time that the programmed feed gives, s; NaN for rapids and where feed per turn has no spindle speed.
  double duration = std::numeric_limits<double>::quiet_NaN();

  /// t = 0..1.
  Eigen::Vector3d point(double t) const;
  double length() const;
};

}  // namespace volcal
