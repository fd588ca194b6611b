#include "volcal/identify/solve/tool_tips.h"

#include <Eigen/Core>
#include <set>

namespace volcal {
namespace {

constexpr double kDistinctTips = 10e-3;  // m, tips of tools that readings separate

/// The axis that an error function, or a squareness, belongs to.
std::optional<AxisName> axis_of_error(const std::string& name) {
  if (const auto symbol = ErrorSymbol::parse(name)) return symbol->axis;
  return turned_axis(name);
}

/// Tips of all tools in use lie on one line: nothing tells the turns about it from no turn. "X", "Y" or "Z"
/// across the line, or nothing.
std::optional<char> across_tool_line(const Campaign& campaign) {
  const auto offset = [&](const Setup& setup) -> const Eigen::Vector3d& {
    return campaign.machine.tools[setup.tool].offset;
  };
  const Eigen::Vector3d first = offset(campaign.setups.front());
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  for (const Setup& setup : campaign.setups) {
    if ((offset(setup) - first).norm() > along.norm()) along = offset(setup) - first;
  }
  if (along.norm() < kDistinctTips) return std::nullopt;
  along.normalize();
  for (const Setup& setup : campaign.setups) {
    const Eigen::Vector3d from_first = offset(setup) - first;
    if ((from_first - from_first.dot(along) * along).norm() > kDistinctTips) return std::nullopt;
  }
  Eigen::Index least = 0;
  along.cwiseAbs().minCoeff(&least);
  return "XYZ"[least];
}

/// Rotations of one axis and what goes with them: what a tool off the line of the others separates.
bool turns_about_tools(const std::string& error, const std::vector<std::string>& partners) {
  std::set<AxisName> axes;
  bool rotation = false;
  const auto add = [&](const std::string& name) {
    const auto symbol = ErrorSymbol::parse(name);
    rotation = rotation || (symbol && is_rotation(symbol->component));
    if (const auto axis = axis_of_error(name)) axes.insert(*axis);
  };
  add(error);
  for (const std::string& partner : partners) add(partner);
  return rotation && axes.size() == 1;
}

}  // namespace

std::optional<AxisName> turned_axis(const std::string& name) {
  const auto location = LocationSymbol::parse(name);
  if (!location || is_rotary(location->axis) || !is_rotation(location->component)) return std::nullopt;
  if (direction_of(location->component) == direction_of(location->axis)) return std::nullopt;
  return location->axis;
}

std::optional<char> third_tool_across(const Campaign& campaign, const std::string& error,
                                      const std::vector<std::string>& partners) {
  if (!turns_about_tools(error, partners)) return std::nullopt;
  return across_tool_line(campaign);
}

}  // namespace volcal
