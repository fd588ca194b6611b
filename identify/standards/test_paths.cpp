#include "volcal/identify/standards/test_paths.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>
#include <variant>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/standards/approach.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/kinematics/chain.h"

namespace volcal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kLargestCircle = 10.0;
using Rows = std::vector<std::size_t>;
template <class Path>
using PathOrReason = std::variant<Path, FindingCode>;

/// Commanded positions of a setup: of the linear axes, and of the functional point.
struct CommandedPoints {
  CommandedPoints(const Campaign& campaign, const Setup& commanded_setup)
      : setup(commanded_setup),
        chain(campaign.machine),
        tool_offset(campaign.machine.tools[setup.tool].offset),
        point_w(nominal_points_w(campaign, setup)) {
    for (std::size_t row = 0; row < setup.readings.size(); ++row) {
      const AxisPosition position = setup.readings.commanded_position(row);
      linear.emplace_back(position[0], position[1], position[2]);
    }
    for (const AxisName axis : kParallelAxes) take_parallel(axis);
  }

  /// Where U, V or W moves, the position along its direction is its own, where the other moves too the sum.
  void take_parallel(AxisName axis) {
    Rows rows(setup.readings.size());
    std::iota(rows.begin(), rows.end(), std::size_t{0});
    if (rows.empty() || !moves(rows, axis, kPathTolerance)) return;
    const bool alone = !moves(rows, main_axis_of(axis), kPathTolerance);
    for (const std::size_t row : rows) {
      double& along = linear[row][direction_of(axis)];
      along = (alone ? 0.0 : along) + setup.readings.position[index_of(axis)][row];
    }
  }

  /// X, Y, Z, then U, V, W.
  std::vector<AxisName> moving_linear_axes(const Rows& rows) const {
    std::vector<AxisName> moving;
    for (const auto& axes : {kLinearAxes, kParallelAxes}) {
      for (const AxisName axis : axes) {
        if (moves(rows, axis, kPathTolerance)) moving.push_back(axis);
      }
    }
    return moving;
  }

  bool moves(const Rows& rows, AxisName axis, double tolerance) const {
    const auto& column = setup.readings.position[index_of(axis)];
    if (column.empty()) return false;
    const auto [low, high] = std::minmax_element(
        rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) { return column[a] < column[b]; });
    return column[*high] - column[*low] > tolerance;
  }

  bool turns(const Rows& rows) const {
    return std::any_of(kAllAxes.begin(), kAllAxes.end(),
                       [&](AxisName axis) { return is_rotary(axis) && moves(rows, axis, kSamePosition); });
  }

  /// Motion of the functional point per metre of an axis.
  Vector3d axis_direction_w(std::size_t row, AxisName axis) const {
    AxisPosition position = setup.readings.commanded_position(row);
    const Vector3d here = chain.nominal_point_w(position, tool_offset);
    position[index_of(axis)] += 1.0;
    return chain.nominal_point_w(position, tool_offset) - here;
  }

  const Setup& setup;
  KinematicChain chain;
  Vector3d tool_offset;
  std::vector<Vector3d> linear;
  std::vector<Vector3d> point_w;
};

Rows all_rows(const Setup& setup) {
  Rows rows(setup.readings.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return rows;
}

/// A straight line in the space of the linear axes.
struct AxisLine {
  Vector3d start;
  Vector3d direction;

  double along(const Vector3d& point) const { return direction.dot(point - start); }
  bool holds(const Vector3d& point) const {
    return (point - start - along(point) * direction).norm() <= kPathTolerance;
  }
};

std::size_t farthest_from_first(const Rows& rows, const std::vector<Vector3d>& points) {
  return *std::max_element(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) {
    return (points[a] - points[rows.front()]).norm() < (points[b] - points[rows.front()]).norm();
  });
}

std::string signed_name(const std::vector<AxisName>& moving, const Vector3d& direction) {
  if (moving.size() == 1) return {letter_of(moving.front())};
  std::string name;
  for (const AxisName axis : moving) {
    name += direction[direction_of(axis)] > 0.0 ? '+' : '-';
    name += letter_of(axis);
  }
  return name;
}

/// Of two axes with one direction no path of one axis or two can be told.
bool share_a_direction(const std::vector<AxisName>& axes) {
  std::array<int, 3> count{};
  for (const AxisName axis : axes) ++count[static_cast<std::size_t>(direction_of(axis))];
  return std::ranges::any_of(count, [](int axes_along) { return axes_along > 1; });
}

struct Line {
  AxisLine geometry;
  StraightPath path;
};

PathOrReason<Line> recognise_line(const CommandedPoints& commanded, const Rows& rows) {
  if (commanded.turns(rows)) return FindingCode::NoTestRotaryAxisMoves;
  Line line;
  line.path.moving = commanded.moving_linear_axes(rows);
  if (line.path.moving.empty()) return FindingCode::NoTestNoAxisMoves;
  if (share_a_direction(line.path.moving)) return FindingCode::NoTestNoStraightLine;
  const Vector3d& first = commanded.linear[rows.front()];
  const std::size_t far = farthest_from_first(rows, commanded.linear);
  line.geometry = {first, (commanded.linear[far] - first).normalized()};
  line.path.direction_w = (commanded.point_w[far] - commanded.point_w[rows.front()]).normalized();
  const bool on_line = std::all_of(
      rows.begin(), rows.end(), [&](std::size_t row) { return line.geometry.holds(commanded.linear[row]); });
  if (!on_line) return FindingCode::NoTestNoStraightLine;
  if (line.path.moving.size() == 1 && line.geometry.direction.sum() < 0.0) {
    line.geometry.direction *= -1.0;
    line.path.direction_w *= -1.0;
  }
  line.path.name = signed_name(line.path.moving, line.geometry.direction);
  line.path.rows = rows;
  return line;
}

bool same_path(const CommandedPoints& commanded, const Line& line, const Line& other) {
  return std::all_of(other.path.rows.begin(), other.path.rows.end(),
                     [&](std::size_t row) { return line.geometry.holds(commanded.linear[row]); });
}

/// Approach along `direction` that the moving axes' columns agree on; 0 when they say nothing or disagree.
int stated_approach(const Readings& readings, const std::vector<AxisName>& moving, const Vector3d& direction,
                    std::size_t row) {
  int sum = 0, known = 0;
  for (const AxisName axis : moving) {
    const auto& column = readings.direction[index_of(axis)];
    if (column.empty() || column[row] == 0) continue;
    sum += direction[direction_of(axis)] > 0.0 ? column[row] : -column[row];
    ++known;
  }
  if (known == 0 || std::abs(sum) != known) return 0;
  return sum > 0 ? 1 : -1;
}

void complete(const CommandedPoints& commanded, Line& line) {
  StraightPath& path = line.path;
  const Readings& readings = commanded.setup.readings;
  std::sort(path.rows.begin(), path.rows.end());
  const bool one_axis = path.moving.size() == 1;
  std::map<std::size_t, std::size_t> place;
  for (const std::size_t row : path.rows) {
    place.emplace(row, path.along.size());
    const Vector3d& point = commanded.linear[row];
    path.along.push_back(one_axis ? point[direction_of(path.moving.front())] : line.geometry.along(point));
  }
  path.approach.assign(path.rows.size(), 0);
  for (const Pass& pass : passes(readings)) {
    std::vector<std::size_t> places;
    std::vector<double> along;
    for (const std::size_t row : pass.rows) {
      const auto found = place.find(row);
      if (found == place.end()) continue;
      places.push_back(found->second);
      along.push_back(path.along[found->second]);
    }
    const std::vector<int> from_order = approach_from_order(along);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const int stated =
          stated_approach(readings, path.moving, line.geometry.direction, path.rows[places[k]]);
      path.approach[places[k]] = stated != 0 ? stated : from_order[k];
    }
  }
}

struct PlannedCircle {
  Vector2d centre = Vector2d::Zero();  ///< in the two moving axes
  CirclePath path;

  Vector2d in_plane(const Vector3d& linear) const {
    return {linear[direction_of(path.first)], linear[direction_of(path.second)]};
  }
};

/// Algebraic fit, exact for points on a circle.
std::optional<Vector3d> centre_and_radius(const std::vector<Vector2d>& points) {
  Vector2d mean = Vector2d::Zero();
  for (const auto& point : points) mean += point / static_cast<double>(points.size());
  const auto rows = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd design(rows, 3);
  Eigen::VectorXd square(rows);
  for (Eigen::Index k = 0; k < rows; ++k) {
    const Vector2d p = points[static_cast<std::size_t>(k)] - mean;
    design.row(k) << 2.0 * p.x(), 2.0 * p.y(), 1.0;
    square[k] = p.squaredNorm();
  }
  const LeastSquares fitted = least_squares(design, square);
  if (rows < 4 || fitted.rank < 3) return std::nullopt;
  const Vector3d solution = fitted.solution;
  const Vector2d centre = solution.head<2>();
  return Vector3d(centre.x() + mean.x(), centre.y() + mean.y(),
                  std::sqrt(solution.z() + centre.squaredNorm()));
}

PathOrReason<PlannedCircle> recognise_circle(const CommandedPoints& commanded, const Rows& rows) {
  if (commanded.turns(rows)) return FindingCode::NoTestRotaryAxisMoves;
  const std::vector<AxisName> moving = commanded.moving_linear_axes(rows);
  if (moving.size() != 2 || share_a_direction(moving)) return FindingCode::NoTestNotTwoAxesMove;
  PlannedCircle circle;
  // In the order of the directions round the third.
  const bool in_order = (direction_of(moving[0]) + 1) % 3 == direction_of(moving[1]);
  circle.path.first = moving[in_order ? 0 : 1];
  circle.path.second = moving[in_order ? 1 : 0];
  std::vector<Vector2d> points;
  for (const std::size_t row : rows) points.push_back(circle.in_plane(commanded.linear[row]));
  const auto fitted = centre_and_radius(points);
  if (!fitted || !(fitted->z() < kLargestCircle)) return FindingCode::NoTestNoCircle;
  circle.centre = fitted->head<2>();
  circle.path.radius = fitted->z();
  for (const auto& point : points) {
    if (std::abs((point - circle.centre).norm() - fitted->z()) > kPathTolerance) {
      return FindingCode::NoTestNoCircle;
    }
  }
  const std::size_t row = rows.front();
  circle.path.first_w = commanded.axis_direction_w(row, circle.path.first);
  circle.path.second_w = commanded.axis_direction_w(row, circle.path.second);
  const Vector2d to_centre = circle.centre - points.front();
  circle.path.centre_w =
      commanded.point_w[row] + to_centre.x() * circle.path.first_w + to_centre.y() * circle.path.second_w;
  circle.path.rows = rows;
  return circle;
}

bool same_path(const CommandedPoints& /*commanded*/, const PlannedCircle& circle,
               const PlannedCircle& other) {
  return circle.path.first == other.path.first &&
         (circle.path.centre_w - other.path.centre_w).norm() <= kPathTolerance &&
         std::abs(circle.path.radius - other.path.radius) <= kPathTolerance;
}

void complete(const CommandedPoints& commanded, PlannedCircle& circle) {
  CirclePath& path = circle.path;
  std::sort(path.rows.begin(), path.rows.end());
  std::map<std::size_t, std::size_t> place;
  for (const std::size_t row : path.rows) {
    place.emplace(row, path.angle.size());
    const Vector2d radial = circle.in_plane(commanded.linear[row]) - circle.centre;
    path.angle.push_back(std::atan2(radial.y(), radial.x()));
    path.commanded_radius.push_back(radial.norm());
  }
  path.sense.assign(path.rows.size(), 0);
  for (const Pass& pass : passes(commanded.setup.readings)) {
    std::vector<std::size_t> places;
    std::vector<double> arc;  // unrolled, m
    for (const std::size_t row : pass.rows) {
      const auto found = place.find(row);
      if (found == place.end()) continue;
      const double angle = path.angle[found->second];
      const double previous = arc.empty() ? 0.0 : path.angle[places.back()];
      const double turn = arc.empty() ? 0.0 : std::remainder(angle - previous, 2.0 * std::numbers::pi);
      arc.push_back((arc.empty() ? 0.0 : arc.back()) + path.radius * turn);
      places.push_back(found->second);
    }
    const std::vector<int> sense = approach_from_order(arc);
    for (std::size_t k = 0; k < places.size(); ++k) path.sense[places[k]] = sense[k];
  }
}

/// The whole setup as one path, else its passes, put together where they share one.
template <class Found, class Path, class Recognise>
FoundPaths<Path> find_paths(const Campaign& campaign, const Setup& setup, Recognise recognise) {
  FoundPaths<Path> result;
  if (setup.readings.size() == 0) {
    result.not_recognised = {{FindingCode::NoTestWithoutReadings, {{"setup", setup.name}}}};
    return result;
  }
  const CommandedPoints commanded(campaign, setup);
  std::vector<Found> found;
  std::map<FindingCode, std::vector<std::int32_t>> failures;
  PathOrReason<Found> whole = recognise(commanded, all_rows(setup));
  if (auto* path = std::get_if<Found>(&whole)) {
    found.push_back(std::move(*path));
  } else {
    for (const Pass& pass : passes(setup.readings)) {
      PathOrReason<Found> part = recognise(commanded, pass.rows);
      auto* one = std::get_if<Found>(&part);
      if (!one) {
        failures[std::get<FindingCode>(part)].push_back(pass.line);
        continue;
      }
      const auto same = std::find_if(found.begin(), found.end(),
                                     [&](const Found& other) { return same_path(commanded, other, *one); });
      if (same == found.end()) {
        found.push_back(std::move(*one));
      } else {
        same->path.rows.insert(same->path.rows.end(), one->path.rows.begin(), one->path.rows.end());
      }
    }
  }
  for (Found& one : found) {
    complete(commanded, one);
    result.paths.push_back(std::move(one.path));
  }
  for (const auto& [reason, lines] : failures) {
    Finding finding{reason, {{"setup", setup.name}}};
    if (!found.empty() || failures.size() > 1) {
      finding.data["line"] = std::int64_t{lines.front()};
      finding.data["more_lines"] = static_cast<std::int64_t>(lines.size()) - 1;
    }
    result.not_recognised.push_back(std::move(finding));
  }
  return result;
}

}  // namespace

std::vector<Vector3d> nominal_points_w(const Campaign& campaign, const Setup& setup) {
  const KinematicChain chain(campaign.machine);
  std::vector<Vector3d> points;
  for (std::size_t row = 0; row < setup.readings.size(); ++row) {
    points.push_back(chain.nominal_point_w(setup.readings.commanded_position(row),
                                           campaign.machine.tools[setup.tool].offset));
  }
  return points;
}

FoundPaths<StraightPath> straight_paths(const Campaign& campaign, const Setup& setup) {
  return find_paths<Line, StraightPath>(campaign, setup, recognise_line);
}

FoundPaths<CirclePath> circle_paths(const Campaign& campaign, const Setup& setup) {
  return find_paths<PlannedCircle, CirclePath>(campaign, setup, recognise_circle);
}

}  // namespace volcal
