#include "volcal/identify/planning/line_of_sight.h"

#include <algorithm>
#include <cmath>

namespace volcal {
namespace {

constexpr double kBesideShare = 0.3;   // of the travel
constexpr double kLeastBeside = 0.25;  // m
constexpr double kFarAbove = 100.0;    // m: the spindle's end

/// Opposite to the tools, along a coordinate direction.
Eigen::Vector3d spindle_direction(const Machine& machine) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Tool& tool : machine.tools) sum += tool.offset;
  if (sum.norm() < 1e-6) return Eigen::Vector3d::UnitZ();
  int along = 0;
  sum.cwiseAbs().maxCoeff(&along);
  return -Eigen::Vector3d::Unit(along) * std::copysign(1.0, sum[along]);
}

}  // namespace

AxisPosition position_at_share(const Machine& machine, const Eigen::Vector3d& share) {
  AxisPosition position{};
  for (const Axis& axis : machine.axes) {
    position[index_of(axis.name)] =
        is_rotary(axis.name) ? axis.home : axis.travel_min + share[direction_of(axis.name)] * axis.travel();
  }
  return position;
}

double distance_from_half_line(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                               const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  // Distance to the half line is convex along the segment: golden sections.
  const auto distance = [&](double share) -> double {
    const Eigen::Vector3d arm = a + share * (b - a) - from;
    const double along = std::max(0.0, arm.dot(direction));
    return (arm - along * direction).norm();
  };
  constexpr double kGolden = 0.6180339887498949;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 40; ++i) {
    const double first = high - kGolden * (high - low), second = low + kGolden * (high - low);
    if (distance(first) <= distance(second)) {
      high = second;
    } else {
      low = first;
    }
  }
  return std::min({distance(0.5 * (low + high)), distance(0.0), distance(1.0)});
}

LineOfSight::LineOfSight(const PlanSettings& settings)
    : settings_(settings), chain_(settings.machine), spindle_w_(spindle_direction(settings.machine)) {
  for (std::size_t tool = 0; tool < settings.machine.tools.size(); ++tool) {
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d share(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
      swept_w_.extend(point_w(position_at_share(settings.machine, share), tool));
    }
  }
  const Eigen::Vector3d clearance = Eigen::Vector3d::Constant(settings.surroundings.clearance);
  kept_clear_w_ = Eigen::AlignedBox3d(swept_w_.min() - clearance, swept_w_.max() + clearance);
  kept_clear_w_.extend(kept_clear_w_.center() + kFarAbove * spindle_w_);
  const Eigen::Vector3d beside = (kBesideShare * swept_w_.sizes()).cwiseMax(kLeastBeside);
  stations_w_ = Eigen::AlignedBox3d(swept_w_.min() - beside, swept_w_.max() + beside);
  int along = 0;
  spindle_w_.cwiseAbs().maxCoeff(&along);
  const bool up = spindle_w_[along] > 0.0;
  (up ? stations_w_.max() : stations_w_.min())[along] = swept_w_.center()[along];
  (up ? stations_w_.min() : stations_w_.max())[along] = (up ? swept_w_.min() : swept_w_.max())[along];
  if (settings.surroundings.stations_w) stations_w_ = *settings.surroundings.stations_w;
}

bool LineOfSight::can_stand(const Eigen::Vector3d& station_w) const {
  return stations_w_.contains(station_w) && !kept_clear_w_.contains(station_w);
}

Eigen::Vector3d LineOfSight::point_w(const AxisPosition& position, std::size_t tool) const {
  return chain_.nominal_point_w(position, settings_.machine.tools[tool].offset);
}

bool LineOfSight::sees(const Eigen::Vector3d& station_w, const AxisPosition& position,
                       std::size_t tool) const {
  const Eigen::Vector3d point = point_w(position, tool);
  const Eigen::Vector3d beam = point - station_w;
  const double range = beam.norm();
  const InstrumentLimits& limits = settings_.limits;
  if (range < limits.range_min || range > limits.range_max) return false;
  const double elevation = std::asin(std::clamp(beam.z() / range, -1.0, 1.0));
  if (elevation < limits.elevation_min || elevation > limits.elevation_max) return false;
  const Eigen::Vector3d reference = chain_.nominal_point_w(position, Eigen::Vector3d::Zero());
  return distance_from_half_line(station_w, point, reference, spindle_w_) >=
         settings_.surroundings.spindle_radius;
}

}  // namespace volcal
