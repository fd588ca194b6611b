#include "volcal/sim/measurement/rotary_poses.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "volcal/sim/machine/transforms.h"

namespace volcal::sim {
namespace {

constexpr double kWholeTurn = 2.0 * std::numbers::pi;
constexpr double kSameAngle = 1e-9;    // rad
constexpr double kAtTravelEnd = 1e-9;  // m
constexpr double kLeastDirection =
    0.02;                           // smallest volume that three directions of axes span: 1 = at right angles
constexpr double kAtTarget = 1e-6;  // m, of the tool point where two axes follow
constexpr int kPositionsOfATurn = 12;
constexpr int kPositionsOfATilt = 7;

/// Volume that three directions span, of two their area.
double spanned(const Eigen::Matrix3Xd& directions) {
  if (directions.cols() == 3) return std::abs(Eigen::Matrix3d(directions).determinant());
  return std::sqrt((directions.transpose() * directions).eval().determinant());
}

/// Moves along directions that make up a displacement, in the least-squares sense where there are fewer than
/// three.
Eigen::VectorXd moves_along(const Eigen::Matrix3Xd& directions, const Eigen::Vector3d& displacement) {
  if (directions.cols() == 3) return Eigen::Matrix3d(directions).partialPivLu().solve(displacement);
  if (directions.cols() == 0) return Eigen::VectorXd(0);
  const Eigen::MatrixXd normal = directions.transpose() * directions;
  return normal.partialPivLu().solve(directions.transpose() * displacement);
}

/// Positions that one axis takes.
struct RotaryNodes {
  const Axis* axis = nullptr;
  double first = 0.0;
  double step = 0.0;
  int count = 1;
  std::array<double, 2> range{};

  double at(int index) const { return first + step * index; }
};

std::vector<RotaryNodes> nodes_of(const Machine& machine, const RotaryGrid& grid) {
  std::vector<RotaryNodes> all;
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) continue;
    RotaryNodes nodes;
    nodes.axis = &axis;
    nodes.range = rotary_range(grid, axis);
    const bool closed = is_whole_turn(nodes.range);
    const auto stated = grid.points.find(axis.name);
    nodes.count = stated != grid.points.end() ? stated->second
                  : closed                    ? kPositionsOfATurn
                                              : kPositionsOfATilt;
    nodes.first = nodes.count > 1 ? nodes.range[0] : axis.home;
    const int steps = closed ? nodes.count : nodes.count - 1;
    nodes.step = steps > 0 ? (nodes.range[1] - nodes.range[0]) / steps : 0.0;
    all.push_back(nodes);
  }
  std::ranges::stable_sort(all, std::greater{}, &RotaryNodes::count);  // the fastest first
  return all;
}

double jittered(const RotaryNodes& nodes, int index, double jitter, RandomStream& random) {
  const double q = nodes.at(index);
  if (jitter == 0.0 || nodes.count < 2) return q;
  return std::clamp(q + jitter * nodes.step * random.uniform(-1.0, 1.0), nodes.range[0], nodes.range[1]);
}

/// Rotary and parallel axes at home.
CommandedPoint rotary_home(const Machine& machine) {
  CommandedPoint point;
  for (const Axis& axis : machine.axes) {
    if (is_rotary(axis.name) || is_parallel(axis.name)) point.position[index_of(axis.name)] = axis.home;
  }
  return point;
}

/// Every combination, each axis there and back while the next moves on.
void append_combined(const Machine& machine, const std::vector<RotaryNodes>& nodes, const RotaryGrid& grid,
                     RandomStream& random, std::vector<CommandedPoint>& path) {
  int total = 1;
  for (const RotaryNodes& axis : nodes) total *= axis.count;
  for (int i = 0; i < total; ++i) {
    CommandedPoint point = rotary_home(machine);
    int rest = i;
    for (const RotaryNodes& axis : nodes) {
      const int place = rest % axis.count;
      rest /= axis.count;  // how often this axis has gone through its positions
      const int index = rest % 2 == 0 ? place : axis.count - 1 - place;
      point.position[index_of(axis.axis->name)] = jittered(axis, index, grid.jitter, random);
    }
    point.line = i / nodes.front().count;
    path.push_back(point);
  }
}

void append_singly(const Machine& machine, const std::vector<RotaryNodes>& nodes, const RotaryGrid& grid,
                   RandomStream& random, std::vector<CommandedPoint>& path) {
  std::int32_t line = 0;
  for (const RotaryNodes& axis : nodes) {
    for (int i = 0; i < axis.count; ++i) {
      CommandedPoint point = rotary_home(machine);
      point.position[index_of(axis.axis->name)] = jittered(axis, i, grid.jitter, random);
      point.line = line;
      path.push_back(point);
    }
    ++line;
  }
}

/// Direction of approach of one axis, as approach() has it of all.
void approach_axis(std::size_t k, const CommandedPoint& from, CommandedPoint& to) {
  const double move = to.position[k] - from.position[k];
  to.direction[k] = move == 0.0 ? from.direction[k] : static_cast<std::int8_t>(move > 0.0 ? 1 : -1);
}

/// The second half of the points has the rotary positions of the first in reverse order, from the other side.
void return_rotary_axes(const Machine& machine, std::vector<CommandedPoint>& points) {
  for (std::size_t i = 0; i < points.size() / 2; ++i) {
    const CommandedPoint& forward = points[i];
    CommandedPoint& back = points[points.size() - 1 - i];
    for (const Axis& axis : machine.axes) {
      if (!is_rotary(axis.name)) continue;
      const std::size_t k = index_of(axis.name);
      back.position[k] = forward.position[k];
      back.direction[k] = static_cast<std::int8_t>(-forward.direction[k]);
    }
  }
}

}  // namespace

std::array<double, 2> rotary_range(const RotaryGrid& grid, const Axis& axis) {
  const auto stated = grid.range.find(axis.name);
  if (stated != grid.range.end()) return stated->second;
  std::array<double, 2> range = {axis.travel_min, axis.travel_max};
  if (axis.travel() > kWholeTurn + kSameAngle) {
    const double low =
        std::clamp(axis.home - 0.5 * kWholeTurn, axis.travel_min, axis.travel_max - kWholeTurn);
    range = {low, low + kWholeTurn};
  }
  return range;
}

bool is_whole_turn(const std::array<double, 2>& range) {
  return std::abs(range[1] - range[0] - kWholeTurn) <= kSameAngle;
}

std::vector<CommandedPoint> rotary_path(const Machine& machine, const RotaryGrid& grid,
                                        RandomStream& random) {
  const std::vector<RotaryNodes> nodes = nodes_of(machine, grid);
  std::vector<CommandedPoint> path;
  if (nodes.empty()) return path;
  if (grid.combined) {
    append_combined(machine, nodes, grid, random, path);
  } else {
    append_singly(machine, nodes, grid, random, path);
  }
  if (!grid.bidirectional) return path;
  std::vector<CommandedPoint> back(path.rbegin(), path.rend());
  const std::int32_t lines = path.back().line + 1;
  for (CommandedPoint& point : back) {
    point.line = 2 * lines - 1 - point.line;
    point.run = 1;
  }
  path.insert(path.end(), back.begin(), back.end());
  return path;
}

Eigen::Matrix3d axes_of_frame(const TruthMachine& machine, const MachineState& state,
                              const std::string& frame) {
  if (frame == "workpiece") return Eigen::Matrix3d::Identity();
  if (frame == "tool") return machine.nominal_tool_axes(state);
  if (frame == "machine") return machine.nominal_bed_axes(state);
  throw std::invalid_argument("\"" + frame + "\" is not a frame of readings");
}

Eigen::Vector3d rotary_direction_w(const TruthMachine& nominal, const CommandedPoint& point, AxisName axis) {
  MachineState state;
  state.position = point.position;
  const Eigen::Matrix3d before = nominal.nominal_tool_axes(state);
  state.position[index_of(axis)] += 0.25 * kWholeTurn;
  return rotation_vector(nominal.nominal_tool_axes(state) * before.transpose()).normalized();
}

Follower::Follower(const TruthMachine& nominal, Eigen::Vector3d tool_offset)
    : nominal_(nominal), tool_offset_(std::move(tool_offset)) {
  for (const AxisName axis : kLinearAxes) {
    if (nominal.machine().has_axis(axis)) axes_.push_back(axis);
  }
}

/// Workpiece directions in which the linear axes move the tool point, by columns.
Eigen::Matrix3Xd Follower::directions(const CommandedPoint& rotary) const {
  MachineState state;
  state.position = rotary.position;
  for (const AxisName axis : axes_) state.position[index_of(axis)] = 0.0;
  const Eigen::Vector3d origin_w = nominal_.nominal_point(state, tool_offset_);
  Eigen::Matrix3Xd columns(3, static_cast<Eigen::Index>(axes_.size()));
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    MachineState moved = state;
    moved.position[index_of(axes_[i])] = 1.0;
    columns.col(static_cast<Eigen::Index>(i)) = nominal_.nominal_point(moved, tool_offset_) - origin_w;
  }
  return columns;
}

CommandedPoint Follower::nearest(const CommandedPoint& rotary, const Eigen::Vector3d& target_w) const {
  CommandedPoint point = rotary;
  for (const AxisName axis : axes_) point.position[index_of(axis)] = 0.0;
  const Eigen::Vector3d move_w =
      target_w - nominal_.nominal_point({point.position, point.direction, 0.0, {}}, tool_offset_);
  const Eigen::VectorXd moves = moves_along(directions(rotary), move_w);
  for (std::size_t i = 0; i < axes_.size(); ++i)
    point.position[index_of(axes_[i])] = moves[static_cast<Eigen::Index>(i)];
  return point;
}

Follower::Pose Follower::at(const CommandedPoint& rotary, const Eigen::Vector3d& target_w) const {
  Pose pose{rotary, "", true};
  const Eigen::Matrix3Xd columns = directions(rotary);
  const auto lead_nowhere = [&] {
    for (const AxisName axis : axes_) pose.outside += letter_of(axis);
    pose.leads_there = false;
    return pose;
  };
  if (spanned(columns) < kLeastDirection) return lead_nowhere();
  pose.point = nearest(rotary, target_w);
  const Eigen::Vector3d reached_w =
      nominal_.nominal_point({pose.point.position, pose.point.direction, 0.0, {}}, tool_offset_);
  if ((reached_w - target_w).norm() > kAtTarget) return lead_nowhere();
  for (const AxisName name : axes_) {
    const Axis& axis = nominal_.machine().axis(name);
    const double q = pose.point.position[index_of(name)];
    if (q < axis.travel_min - kAtTravelEnd || q > axis.travel_max + kAtTravelEnd)
      pose.outside += letter_of(name);
  }
  return pose;
}

CommandedPoint Follower::moved(const CommandedPoint& pose, const Eigen::Vector3d& shift_w) const {
  CommandedPoint moved = pose;
  const Eigen::VectorXd moves = moves_along(directions(pose), shift_w);
  for (std::size_t i = 0; i < axes_.size(); ++i)
    moved.position[index_of(axes_[i])] += moves[static_cast<Eigen::Index>(i)];
  return moved;
}

void add_rotary_motion(const Machine& machine, RotaryMotion motion, const RotaryGrid& grid,
                       bool there_and_back, RandomStream& random, std::vector<CommandedPoint>& points) {
  if (motion == RotaryMotion::Home) return;
  const std::size_t half = there_and_back ? points.size() / 2 : points.size();
  const std::vector<CommandedPoint> nodes =
      motion == RotaryMotion::Grid ? rotary_path(machine, grid, random) : std::vector<CommandedPoint>{};
  for (std::size_t i = 0; i < half; ++i) {
    for (const Axis& axis : machine.axes) {
      if (!is_rotary(axis.name)) continue;
      const std::size_t k = index_of(axis.name);
      const auto [low, high] = rotary_range(grid, axis);
      points[i].position[k] = nodes.empty() ? random.uniform(low, high) : nodes[i % nodes.size()].position[k];
      if (i > 0) approach_axis(k, points[i - 1], points[i]);
    }
  }
  if (there_and_back) return_rotary_axes(machine, points);
}

}  // namespace volcal::sim
