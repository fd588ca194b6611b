#include "volcal/identify/program/nc_motion.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kSamePoint = 1e-9;  // m

Eigen::Vector2d in_plane(const NcPlane& plane, const Eigen::Vector3d& point) {
  return {point[plane.first], point[plane.second]};
}

/// Angle from start to end in the direction of the arc, a full turn where they coincide.
double swept_angle(const NcArcWords& words, double start_angle, double end_angle) {
  const Eigen::Vector2d chord = in_plane(words.plane, words.end) - in_plane(words.plane, words.start);
  double angle = words.clockwise ? start_angle - end_angle : end_angle - start_angle;
  angle -= kTurn * std::floor(angle / kTurn);
  if (chord.norm() < kSamePoint) angle = kTurn;
  angle += kTurn * (words.turns - 1);
  return words.clockwise ? -angle : angle;
}

}  // namespace

NcPlane NcPlane::of_code(int tenths) {
  if (tenths == 180) return {2, 0, 1};
  if (tenths == 190) return {1, 2, 0};
  return {0, 1, 2};
}

Eigen::Vector3d NcArc::point(double t) const {
  if (t <= 0.0) return start;
  if (t >= 1.0) return end;
  const double angle = start_angle + t * sweep;
  const double radius = start_radius + t * (end_radius - start_radius);
  Eigen::Vector3d at;
  at[plane.first] = centre.x() + radius * std::cos(angle);
  at[plane.second] = centre.y() + radius * std::sin(angle);
  at[plane.across] = start[plane.across] + t * (end[plane.across] - start[plane.across]);
  return at;
}

Eigen::Vector3d NcArc::tangent(double t) const {
  const double angle = start_angle + t * sweep;
  const double radius = start_radius + t * (end_radius - start_radius);
  const Eigen::Vector2d outwards(std::cos(angle), std::sin(angle));
  const Eigen::Vector2d along =
      (end_radius - start_radius) * outwards + radius * sweep * Eigen::Vector2d(-outwards.y(), outwards.x());
  Eigen::Vector3d change;
  change[plane.first] = along.x();
  change[plane.second] = along.y();
  change[plane.across] = end[plane.across] - start[plane.across];
  return change;
}

double NcArc::length() const {
  return std::hypot(0.5 * (start_radius + end_radius) * sweep, end[plane.across] - start[plane.across]);
}

NcArc arc_about(const NcArcWords& words, const Eigen::Vector2d& centre) {
  const Eigen::Vector2d from = in_plane(words.plane, words.start) - centre;
  const Eigen::Vector2d to = in_plane(words.plane, words.end) - centre;
  NcArc arc{words.plane, words.start, words.end, centre};
  arc.start_radius = from.norm();
  arc.end_radius = to.norm();
  if (arc.start_radius < kSamePoint) throw std::invalid_argument("the arc's centre is its start");
  const double difference = std::abs(arc.end_radius - arc.start_radius);
  if (difference > std::max(kArcRadiusTolerance, 1e-3 * arc.start_radius))
    throw std::invalid_argument(
        fmt::format("the arc's radius is {:.4f} mm at its start and {:.4f} mm at its end",
                    arc.start_radius / kMetrePerMillimetre, arc.end_radius / kMetrePerMillimetre));
  arc.start_angle = std::atan2(from.y(), from.x());
  arc.sweep = swept_angle(words, arc.start_angle, std::atan2(to.y(), to.x()));
  return arc;
}

NcArc arc_of_radius(const NcArcWords& words, double radius) {
  const Eigen::Vector2d from = in_plane(words.plane, words.start);
  const Eigen::Vector2d chord = in_plane(words.plane, words.end) - from;
  const double half = 0.5 * chord.norm();
  if (half < kSamePoint)
    throw std::invalid_argument("an arc with R ends where it starts, which leaves its centre open");
  if (half > std::abs(radius) + kArcRadiusTolerance)
    throw std::invalid_argument(fmt::format("an arc of radius {:.4f} mm does not reach over {:.4f} mm",
                                            std::abs(radius) / kMetrePerMillimetre,
                                            2.0 * half / kMetrePerMillimetre));
  const double height = std::sqrt(std::max(radius * radius - half * half, 0.0));
  // The centre lies to the left of the chord for the shorter counter-clockwise arc.
  const bool left = words.clockwise == (radius < 0.0);
  const Eigen::Vector2d normal = Eigen::Vector2d(-chord.y(), chord.x()) / chord.norm();
  return arc_about(words, from + 0.5 * chord + (left ? height : -height) * normal);
}

Eigen::Vector3d NcMotion::point(double t) const {
  if (kind == NcMotionKind::Arc) return arc.point(t);
  return t >= 1.0 ? to : Eigen::Vector3d(from + t * (to - from));
}

double NcMotion::length() const { return kind == NcMotionKind::Arc ? arc.length() : (to - from).norm(); }

}  // namespace volcal
