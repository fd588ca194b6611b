#include "volcal/identify/program/tcp/tcp_machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kTcpTurn = 2.0 * std::numbers::pi;
constexpr double kReached = 1e-9;  // m
constexpr double kSolved = 1e-10;  // m
constexpr int kTcpSteps = 12;
constexpr double kBetweenPlaces = 1e-3;  // m
constexpr double kTurnBetweenPlaces = 0.25 * kRadianPerDegree;
constexpr double kMostPlaces = 1e4;   // of a motion
constexpr double kSlightlyOn = 1e-4;  // of a motion: where the directions of its axes are looked at
constexpr double kTcpStill = 1e-12;   // m or rad

FiveAxisSettings tcp_settings(const Eigen::Vector3d& tool_offset, bool orientation) {
  FiveAxisSettings settings;
  settings.type = CompensationType::volumetric() | CompensationType::rotary_volumetric();
  if (orientation) settings.type = settings.type | CompensationPart::Orientation;
  settings.tool_offset = tool_offset;
  return settings;
}

/// Rotary positions within a travel of a turn.
AxisPosition counted_within(const Machine& machine, AxisPosition position) {
  for (const Axis& axis : machine.axes) {
    double& q = position[index_of(axis.name)];
    if (axis.travels_a_turn() && (q < axis.travel_min || q > axis.travel_max))
      q -= kTcpTurn * std::floor((q - axis.travel_min) / kTcpTurn);
  }
  return position;
}

JointErrorSource within_a_turn(const Machine& machine, JointErrorSource errors) {
  return [machine, errors = std::move(errors)](const AxisPosition& position,
                                               const ApproachDirection& direction) {
    return errors(counted_within(machine, position), direction);
  };
}

}  // namespace

TcpPose TcpPose::between(const TcpPose& from, const TcpPose& to, double t) {
  if (t >= 1.0) return to;
  return {from.point_w + t * (to.point_w - from.point_w), from.rotary + t * (to.rotary - from.rotary)};
}

double tcp_places(const TcpPose& from, const TcpPose& to) {
  const double way = (to.point_w - from.point_w).norm() / kBetweenPlaces +
                     (to.rotary - from.rotary).norm() / kTurnBetweenPlaces;
  return std::clamp(way, 1.0, kMostPlaces);
}

TcpMachine::TcpMachine(const Machine& machine, const Eigen::Vector3d& tool_offset, JointErrorSource errors,
                       bool orientation)
    : machine_(machine),
      chain_(machine),
      tool_(tool_offset),
      errors_(within_a_turn(machine, std::move(errors))),
      compensation_(machine, tcp_settings(tool_offset, orientation), errors_) {}

AxisPosition TcpMachine::with_linear(const Eigen::Vector3d& linear, const Eigen::Vector3d& rotary) const {
  AxisPosition position{};
  for (std::size_t k = 0; k < 3; ++k) {
    position[k] = linear[static_cast<Eigen::Index>(k)];
    position[k + 3] = rotary[static_cast<Eigen::Index>(k)];
  }
  return position;
}

AxisPosition TcpMachine::counted(const AxisPosition& position) const {
  return counted_within(machine_, position);
}

Eigen::Matrix3d TcpMachine::directions_at(const AxisPosition& position) const {
  JointLever levers[kAxisCount];
  chain_.levers(position, tool_, levers);
  return linear_directions(levers, chain_.joint_count());
}

AxisPosition TcpMachine::axes_at(const TcpPose& pose) const {
  const AxisPosition turned = with_linear(Eigen::Vector3d::Zero(), pose.rotary);
  const Eigen::Vector3d missing = pose.point_w - chain_.nominal_point_w(turned, tool_);
  const AxisPosition position = with_linear(linear_moves(directions_at(turned), missing), pose.rotary);
  if ((chain_.nominal_point_w(position, tool_) - pose.point_w).norm() > kReached)
    throw std::runtime_error("X, Y and Z do not reach the point with the rotary axes where they are sent");
  return position;
}

KinematicChain::Pose<double> TcpMachine::actual(const AxisPosition& commanded,
                                                const ApproachDirection& direction) const {
  return chain_.exact_pose<double>(commanded, tool_, errors_(commanded, direction));
}

TcpPose TcpMachine::command(const TcpPose& pose, const ApproachDirection& direction) const {
  const AxisPosition meant = axes_at(pose);
  const Eigen::Matrix3d directions = directions_at(meant);
  TcpPose sent;
  sent.rotary = pose.rotary + compensation_.correction(meant, direction).rotary;
  Eigen::Vector3d linear(meant[0], meant[1], meant[2]);
  for (int step = 0; step < kTcpSteps; ++step) {
    const Eigen::Vector3d missing =
        pose.point_w - actual(with_linear(linear, sent.rotary), direction).point_w;
    if (missing.norm() < kSolved) break;
    linear += linear_moves(directions, missing);
  }
  sent.point_w = chain_.nominal_point_w(with_linear(linear, sent.rotary), tool_);
  return sent;
}

TcpMachine::Left TcpMachine::left(const TcpPose& sent, const TcpPose& meant,
                                  const ApproachDirection& direction) const {
  const KinematicChain::Pose<double> there = actual(axes_at(sent), direction);
  const Eigen::Vector3d axis = there.rotation_wt.col(2);
  const Eigen::Vector3d wanted =
      chain_.nominal_rotation_wt(with_linear(Eigen::Vector3d::Zero(), meant.rotary)).col(2);
  return {(there.point_w - meant.point_w).norm(), std::atan2(axis.cross(wanted).norm(), axis.dot(wanted))};
}

ApproachDirection TcpMachine::directions(const TcpPose& from, const TcpPose& to, double t,
                                         const ApproachDirection& held) const {
  const double begin = std::clamp(t - 0.5 * kSlightlyOn, 0.0, 1.0 - kSlightlyOn);
  const AxisPosition before = axes_at(TcpPose::between(from, to, begin));
  const AxisPosition after = axes_at(TcpPose::between(from, to, begin + kSlightlyOn));
  ApproachDirection directions = held;
  for (std::size_t i = 0; i < kAxisCount; ++i) {
    const double moved = after[i] - before[i];
    if (std::abs(moved) > kTcpStill) directions[i] = moved > 0.0 ? 1 : -1;
  }
  return directions;
}

TcpMachines::TcpMachines(const Machine& machine, ErrorsOfOffset errors, bool orientation)
    : machine_(machine), errors_(std::move(errors)), orientation_(orientation) {}

const TcpMachine& TcpMachines::with(const Eigen::Vector3d& tool_offset) {
  const std::string key =
      fmt::format("{:.9f} {:.9f} {:.9f}", tool_offset.x(), tool_offset.y(), tool_offset.z());
  const auto known = machines_.find(key);
  if (known != machines_.end()) return known->second;
  return machines_.try_emplace(key, machine_, tool_offset, errors_(tool_offset), orientation_).first->second;
}

}  // namespace volcal
