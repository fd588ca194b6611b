#include "volcal/identify/planning/swept_volume.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "volcal/model/description/unknowns.h"

namespace volcal {
namespace {

constexpr double kProgrammedSteps = 1e6;  // per metre
constexpr double kAtPoint = 1e-6;         // m

/// Opposite to the tools, along a coordinate direction.
Eigen::Vector3d spindle_direction(const Machine& machine) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Tool& tool : machine.tools) sum += tool.offset;
  if (sum.norm() < 1e-6) return Eigen::Vector3d::UnitZ();
  int along = 0;
  sum.cwiseAbs().maxCoeff(&along);
  return -Eigen::Vector3d::Unit(along) * std::copysign(1.0, sum[along]);
}

/// Moves along two directions that lead nearest to a point; the third column is zero, and so is its move.
Eigen::Vector3d nearest_moves(Eigen::Matrix3d directions, const Eigen::Vector3d& wanted) {
  for (int k = 0; k < 3; ++k) {
    if (!directions.col(k).isZero()) continue;
    directions.col(k) = directions.col((k + 1) % 3).cross(directions.col((k + 2) % 3));
    Eigen::Vector3d moves = directions.inverse() * wanted;
    moves[k] = 0.0;
    return moves;
  }
  return directions.inverse() * wanted;
}

}  // namespace

double programmed_position(double q) { return std::round(q * kProgrammedSteps) / kProgrammedSteps; }

AxisPosition home_position(const Machine& machine) {
  AxisPosition position{};
  for (const Axis& axis : machine.axes) position[index_of(axis.name)] = axis.home;
  return position;
}

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

SweptVolume::SweptVolume(const PlanSettings& settings)
    : settings_(settings), chain_(settings.machine), spindle_w_(spindle_direction(settings.machine)) {
  for (std::size_t tool = 0; tool < settings.machine.tools.size(); ++tool) {
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d share(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
      box_w_.extend(point_w(position_at_share(settings.machine, share), tool));
    }
  }
}

int SweptVolume::along_spindle() const {
  int along = 0;
  spindle_w_.cwiseAbs().maxCoeff(&along);
  return along;
}

Eigen::Vector3d SweptVolume::point_w(const AxisPosition& position, std::size_t tool) const {
  return chain_.nominal_point_w(position, settings_.machine.tools[tool].offset);
}

std::optional<AxisPosition> SweptVolume::position_at(const Eigen::Vector3d& wanted_w,
                                                     std::size_t tool) const {
  return position_at(wanted_w, tool, home_position(settings_.machine));
}

std::optional<AxisPosition> SweptVolume::position_at(const Eigen::Vector3d& wanted_w, std::size_t tool,
                                                     const AxisPosition& rotary) const {
  AxisPosition position = rotary;
  const std::vector<AxisName> axes = settings_.machine.linear_axes();
  for (const AxisName name : axes) position[index_of(name)] = 0.0;
  const Eigen::Vector3d at_zero = point_w(position, tool);
  Eigen::Matrix3d directions = Eigen::Matrix3d::Zero();
  for (const AxisName name : axes) {
    AxisPosition moved = position;
    moved[index_of(name)] = 1.0;
    directions.col(direction_of(name)) = point_w(moved, tool) - at_zero;
  }
  const Eigen::Vector3d wanted = wanted_w - at_zero;
  const Eigen::Vector3d moves =
      axes.size() == 3 ? Eigen::Vector3d(directions.inverse() * wanted) : nearest_moves(directions, wanted);
  if ((directions * moves - wanted).norm() > kAtPoint) return std::nullopt;
  for (const AxisName name : axes) {
    const double q = programmed_position(moves[direction_of(name)]);
    const Axis& axis = settings_.machine.axis(name);
    if (q < axis.travel_min || q > axis.travel_max) return std::nullopt;
    position[index_of(name)] = q;
  }
  return position;
}

bool SweptVolume::passes_spindle(const Eigen::Vector3d& from_w, const AxisPosition& position,
                                 std::size_t tool) const {
  const Eigen::Vector3d reference = chain_.nominal_point_w(position, Eigen::Vector3d::Zero());
  const Eigen::Vector3d spindle_w = chain_.nominal_rotation_wt(position) * spindle_w_;
  return distance_from_half_line(from_w, point_w(position, tool), reference, spindle_w) >=
         settings_.surroundings.spindle_radius;
}

}  // namespace volcal
