/// Tables of rotary axes: what they add to the commands as each axis turns, and the error over the positions
/// of two axes without and with them. By the tables as the controller reads them and the exact model, mean of
/// both directions of approach.

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <vector>

#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/errors/rotary/rotary_map.h"
#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/page.h"

namespace volcal::report {
namespace {

/// Added to the commands for the errors of rotary axes, over the positions of one; other rotary axes at 0 or
/// as near to it as they come.
struct RotaryAxisAdded {
  AxisName axis = AxisName::C;
  std::vector<double> position;
  std::vector<double> turned;          ///< of the axis itself, rad
  std::vector<Eigen::Vector3d> moved;  ///< of X, Y, Z, m
};

struct TablePictures {
  std::string tool;
  Eigen::Vector3d point_w = Eigen::Vector3d::Zero();  ///< where the tool point stays, m
  std::vector<RotaryAxisAdded> axes;
  std::vector<RotaryNodes> map_axes;  ///< one or two
  std::vector<RotaryCorrected> map;   ///< the last axis fastest
};

constexpr double kAxisStep = 5.0 * kRadianPerDegree;
constexpr double kErrorMapStep = 10.0 * kRadianPerDegree;

/// Nodes of one axis, the tool point staying where it is.
std::vector<AxisPosition> poses_along(const Machine& machine, const Tool& tool,
                                      const Eigen::Vector3d& point_w, const RotaryAxisAdded& added) {
  std::vector<AxisPosition> poses;
  for (const double at : added.position) {
    AxisPosition rotary = rotary_axes_at_rest(machine);
    rotary[index_of(added.axis)] = at;
    poses.push_back(followed_pose(machine, tool, point_w, rotary));
  }
  return poses;
}

/// Empty of tables without a type for rotary axes.
std::optional<TablePictures> table_pictures(const FitResult& result, const MadeTables& made) {
  if (!made.rotary_check) return std::nullopt;
  const Tool& tool = tool_of(result.machine, made.options);
  TablePictures pictures;
  pictures.tool = tool.name;
  pictures.point_w = middle_point_w(result.machine, tool);
  const RotaryMap map =
      rotary_map(result, tool, pictures.point_w, conditions_of(result, made.options), kErrorMapStep);
  std::vector<AxisPosition> poses = map.poses;
  for (const AxisName axis : identified_rotary_axes(result)) {
    pictures.axes.push_back({axis, rotary_nodes(result, axis, kAxisStep).positions, {}, {}});
    std::ranges::copy(poses_along(result.machine, tool, pictures.point_w, pictures.axes.back()),
                      std::back_inserter(poses));
  }
  const std::vector<RotaryCorrected> corrected =
      rotary_corrections(*made.format, result, made.options, made.read_back, poses);
  auto each = corrected.begin() + static_cast<std::ptrdiff_t>(map.poses.size());
  pictures.map_axes = map.axes;
  pictures.map.assign(corrected.begin(), each);
  for (RotaryAxisAdded& added : pictures.axes) {
    for (std::size_t i = 0; i < added.position.size(); ++i, ++each) {
      added.turned.push_back(each->correction.rotary[direction_of(added.axis)]);
      added.moved.push_back(each->correction.linear);
    }
  }
  return pictures;
}

Json added_json(const RotaryAxisAdded& added) {
  Json moved = Json::array();
  for (int k = 0; k < 3; ++k) {
    std::vector<double> values;
    for (const Eigen::Vector3d& each : added.moved) values.push_back(each[k]);
    moved.push_back({{"axis", std::string(1, "XYZ"[k])}, {"value", rounded_array(values, kPerMicro, 4)}});
  }
  return {{"axis", axis_letter(added.axis)},
          {"position", rounded_array(added.position, position_factor(added.axis), 6)},
          {"turned", rounded_array(added.turned, kPerMicro, 4)},
          {"moved", std::move(moved)}};
}

/// Sizes of displacements and of errors of the tool's direction, over the map.
Json left_layer(const TablePictures& pictures, FiveAxisCompensation::Left RotaryCorrected::*which) {
  std::vector<double> point, direction;
  for (const RotaryCorrected& each : pictures.map) {
    point.push_back((each.*which).displacement_w.norm());
    direction.push_back((each.*which).axis);
  }
  return {{"position", rounded_array(point, kPerMicro, 4)},
          {"orientation", rounded_array(direction, kPerMicro, 4)}};
}

Json tables_json(const TablesInput& input, bool alone) {
  const auto pictures = table_pictures(input.result, input.made);
  if (!pictures) return nullptr;
  Json axes = Json::array(), map_axes = Json::array();
  for (const RotaryAxisAdded& added : pictures->axes) axes.push_back(added_json(added));
  for (const RotaryNodes& nodes : pictures->map_axes)
    map_axes.push_back({{"name", axis_letter(nodes.axis)},
                        {"places", rounded_array(nodes.positions, position_factor(nodes.axis), 6)}});
  return {{"alone", alone},
          {"format", std::string(input.made.format->name)},
          {"type", input.made.options.type.rotary().name()},
          {"tool", pictures->tool},
          {"point_mm", rounded_vector(pictures->point_w, kPerMilli, 6)},
          {"axes", std::move(axes)},
          {"map_axes", std::move(map_axes)},
          {"before", left_layer(*pictures, &RotaryCorrected::before)},
          {"left", left_layer(*pictures, &RotaryCorrected::left)}};
}

}  // namespace

Json rotary_tables_page(const TablesInput& input) { return tables_json(input, true); }

Json certified_rotary_tables_page(const CertificateInput& input) {
  return tables_json({input.certificate.result, input.certificate.tables}, false);
}

}  // namespace volcal::report
