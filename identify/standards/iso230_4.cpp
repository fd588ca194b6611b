#include "volcal/identify/standards/iso230_4.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "volcal/identify/numeric/dense.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kFullCircleGap = 30.0 * kRadianPerDegree;
constexpr double kQuadrantWindow = 20.0 * kRadianPerDegree;
constexpr double kAngleTolerance = 1e-9;
constexpr int kFewestReadings = 4;

struct Circle {
  double radius = 0.0;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
};

Eigen::Vector2d direction_at(double angle) { return {std::cos(angle), std::sin(angle)}; }

double distance(const Circle& circle, double angle) {
  return (circle.radius * direction_at(angle) - circle.centre).norm();
}

/// Gauss-Newton on distance(circle, angle) = nominal + deviation.
std::optional<Circle> fit_circle(const std::vector<CircleReading>& readings, double nominal) {
  if (readings.size() < kFewestReadings) return std::nullopt;
  const auto rows = static_cast<Eigen::Index>(readings.size());
  Circle circle{nominal, Eigen::Vector2d::Zero()};
  Eigen::MatrixXd jacobian(rows, 3);
  Eigen::VectorXd misfit(rows);
  for (int iteration = 0; iteration < 20; ++iteration) {
    for (Eigen::Index k = 0; k < rows; ++k) {
      const CircleReading& reading = readings[static_cast<std::size_t>(k)];
      const Eigen::Vector2d u = direction_at(reading.angle);
      const Eigen::Vector2d outward = (circle.radius * u - circle.centre).normalized();
      jacobian.row(k) << outward.dot(u), -outward.x(), -outward.y();
      misfit[k] = nominal + reading.deviation - distance(circle, reading.angle);
    }
    const LeastSquares fitted = least_squares(jacobian, misfit);
    if (fitted.rank < 3) return std::nullopt;
    const Eigen::Vector3d step = fitted.solution;
    circle.radius += step[0];
    circle.centre += step.tail<2>();
    if (step.norm() < 1e-15 * nominal) break;
  }
  return circle;
}

struct RadialRange {
  double low = 0.0;
  double high = 0.0;
};

/// Range of the readings about a circle.
RadialRange radial_range(const std::vector<CircleReading>& readings, double nominal, const Circle& circle) {
  const auto value = [&](const CircleReading& reading) {
    return nominal + reading.deviation - distance(circle, reading.angle);
  };
  RadialRange range{value(readings.front()), value(readings.front())};
  for (const auto& reading : readings) {
    range.low = std::min(range.low, value(reading));
    range.high = std::max(range.high, value(reading));
  }
  return range;
}

double largest_gap(const std::vector<CircleReading>& readings) {
  std::vector<double> angles(readings.size());
  std::ranges::transform(readings, angles.begin(), [](const CircleReading& reading) {
    return reading.angle - 2.0 * std::numbers::pi * std::floor(reading.angle / (2.0 * std::numbers::pi));
  });
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + 2.0 * std::numbers::pi - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return gap;
}

std::optional<CircularPath> evaluate_path(const std::vector<CircleReading>& readings, double nominal,
                                          const Eigen::Vector2d& instrument_centre) {
  const std::optional<Circle> circle = fit_circle(readings, nominal);
  if (!circle) return std::nullopt;
  CircularPath path;
  path.readings = static_cast<int>(readings.size());
  path.centre = circle->centre;
  path.largest_gap = largest_gap(readings);
  const RadialRange about_fit = radial_range(readings, nominal, *circle);
  path.circular_deviation = about_fit.high - about_fit.low;
  const bool full = path.largest_gap <= kFullCircleGap + kAngleTolerance;
  path.centring = full ? Centring::LeastSquares : Centring::Instrument;
  const RadialRange about_nominal =
      radial_range(readings, nominal, {nominal, full ? circle->centre : instrument_centre});
  path.radial_max = about_nominal.high;
  path.radial_min = about_nominal.low;
  return path;
}

/// A sense that was not run leaves nothing open.
bool is_full(const std::optional<CircularPath>& path) {
  return !path || path->centring == Centring::LeastSquares;
}

/// Value at 0 of the straight line through points; empty for fewer than two different abscissae.
std::optional<double> line_at_zero(const std::vector<Eigen::Vector2d>& points) {
  if (points.size() < 2) return std::nullopt;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& point : points) mean += point / static_cast<double>(points.size());
  double xx = 0.0, xy = 0.0;
  for (const auto& point : points) {
    xx += (point.x() - mean.x()) * (point.x() - mean.x());
    xy += (point.x() - mean.x()) * (point.y() - mean.y());
  }
  if (xx < kAngleTolerance * kAngleTolerance) return std::nullopt;
  return mean.y() - mean.x() * xy / xx;
}

/// Radius after the quadrant point minus before, in the sense of the path.
std::optional<double> step_at(const std::vector<CircleReading>& readings, double quadrant, int sense) {
  std::vector<Eigen::Vector2d> before, after;
  for (const auto& reading : readings) {
    const double along = sense * std::remainder(reading.angle - quadrant, 2.0 * std::numbers::pi);
    if (std::abs(along) > kQuadrantWindow + kAngleTolerance || std::abs(along) < kAngleTolerance) continue;
    (along < 0.0 ? before : after).emplace_back(along, reading.deviation);
  }
  const auto radius_before = line_at_zero(before);
  const auto radius_after = line_at_zero(after);
  if (!radius_before || !radius_after) return std::nullopt;
  return *radius_after - *radius_before;
}

void add_reversals(const std::vector<CircleReading>& readings, int sense,
                   std::vector<QuadrantReversal>& reversals) {
  for (const int axis : {0, 1}) {
    for (const int side : {+1, -1}) {
      const double quadrant = axis * std::numbers::pi / 2.0 + (side > 0 ? 0.0 : std::numbers::pi);
      const auto step = step_at(readings, quadrant, sense);
      if (step) reversals.push_back({axis, side, sense, -*step});
    }
  }
}

}  // namespace

std::optional<double> CircularFigures::mean_reversal(int axis) const {
  double sum = 0.0;
  int count = 0;
  for (const QuadrantReversal& reversal : reversals) {
    if (reversal.axis != axis) continue;
    sum += reversal.value;
    ++count;
  }
  return count == 0 ? std::nullopt : std::optional(sum / count);
}

CircularFigures circular_figures(std::span<const CircleReading> readings, double nominal_radius,
                                 const Eigen::Vector2d& instrument_centre) {
  std::vector<CircleReading> ccw, cw, both;
  for (const auto& reading : readings) {
    if (reading.sense == 0) continue;
    (reading.sense > 0 ? ccw : cw).push_back(reading);
    both.push_back(reading);
  }
  CircularFigures figures;
  figures.counter_clockwise = evaluate_path(ccw, nominal_radius, instrument_centre);
  figures.clockwise = evaluate_path(cw, nominal_radius, instrument_centre);
  add_reversals(ccw, +1, figures.reversals);
  add_reversals(cw, -1, figures.reversals);
  const std::optional<Circle> circle = fit_circle(both, nominal_radius);
  const bool full = circle && is_full(figures.counter_clockwise) && is_full(figures.clockwise);
  figures.centring = full ? Centring::LeastSquares : Centring::Instrument;
  figures.centre = full ? circle->centre : instrument_centre;
  if (!circle || !figures.counter_clockwise || !figures.clockwise) return figures;
  const RadialRange range = radial_range(both, nominal_radius, *circle);
  figures.bidirectional = range.high - range.low;
  figures.mean_radial = circle->radius - nominal_radius;
  return figures;
}

std::vector<CircleReading> radial_deviations(std::span<const CircleReading> readings, double nominal_radius,
                                             const Eigen::Vector2d& centre) {
  std::vector<CircleReading> about(readings.begin(), readings.end());
  for (CircleReading& reading : about)
    reading.deviation += nominal_radius - distance({nominal_radius, centre}, reading.angle);
  return about;
}

}  // namespace volcal
