#include "volcal/identify/solve/tool_tips.h"

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <utility>

namespace volcal {
namespace {

constexpr double kDistinctTips = 10e-3;  // m, tips of tools that readings separate
constexpr double kLeastMovement = 1e-3;  // of the travel

/// The axis that an error function, or a squareness, belongs to.
std::optional<AxisName> axis_of_error(const MachineError& error) {
  return error.motion() ? error.axis() : turned_axis(error);
}

/// Tips of all these tools lie on one line: nothing tells the turns about it from no turn. "X", "Y" or "Z"
/// across the line, or nothing.
std::optional<char> across_tool_line(const Machine& machine, const std::set<std::size_t>& tools) {
  if (tools.empty()) return std::nullopt;
  const Eigen::Vector3d first = machine.tools[*tools.begin()].offset;
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  for (const std::size_t tool : tools) {
    const Eigen::Vector3d from_first = machine.tools[tool].offset - first;
    if (from_first.norm() > along.norm()) along = from_first;
  }
  if (along.norm() < kDistinctTips) return std::nullopt;
  along.normalize();
  for (const std::size_t tool : tools) {
    const Eigen::Vector3d from_first = machine.tools[tool].offset - first;
    if ((from_first - from_first.dot(along) * along).norm() > kDistinctTips) return std::nullopt;
  }
  Eigen::Index least = 0;
  along.cwiseAbs().minCoeff(&least);
  return "XYZ"[least];
}

/// The axis where all is rotations of one axis and what goes with them: what a tool off the line of the
/// others separates.
std::optional<AxisName> axis_that_turns_tools(const MachineError& error,
                                              const std::vector<MachineError>& partners) {
  std::set<AxisName> axes;
  bool rotation = false;
  const auto add = [&](const MachineError& each) {
    rotation = rotation || (each.motion() && each.is_angle());
    if (const auto axis = axis_of_error(each)) axes.insert(*axis);
  };
  add(error);
  for (const MachineError& partner : partners) add(partner);
  return rotation && axes.size() == 1 ? std::optional(*axes.begin()) : std::nullopt;
}

}  // namespace

std::optional<AxisName> turned_axis(const MachineError& error) {
  const auto location = error.location();
  if (!location || is_rotary(location->axis) || !is_rotation(location->component)) return std::nullopt;
  if (direction_of(location->component) == direction_of(location->axis)) return std::nullopt;
  return location->axis;
}

std::set<std::size_t> tools_moved_by(const Campaign& campaign, AxisName axis) {
  std::map<std::size_t, std::pair<double, double>> ends;  // of the axis, by tool
  for (const Setup& setup : campaign.setups) {
    const std::vector<bool> left_out = setup.rows_left_out();
    const std::vector<double>& position = setup.readings.position[index_of(axis)];
    for (std::size_t row = 0; row < position.size(); ++row) {
      if (left_out[row]) continue;
      const auto [own, is_new] = ends.try_emplace(setup.tool, position[row], position[row]);
      own->second.first = std::min(own->second.first, position[row]);
      own->second.second = std::max(own->second.second, position[row]);
    }
  }
  std::set<std::size_t> tools;
  for (const auto& [tool, end] : ends) {
    if (end.second - end.first > kLeastMovement * campaign.machine.axis(axis).travel()) tools.insert(tool);
  }
  return tools;
}

std::optional<char> third_tool_across(const Campaign& campaign, const MachineError& error,
                                      const std::vector<MachineError>& partners) {
  const auto axis = axis_that_turns_tools(error, partners);
  if (!axis) return std::nullopt;
  return across_tool_line(campaign.machine, tools_moved_by(campaign, *axis));
}

}  // namespace volcal
