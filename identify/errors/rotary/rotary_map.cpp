#include "volcal/identify/errors/rotary/rotary_map.h"

#include <algorithm>
#include <cmath>

#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/model/description/errors.h"

namespace volcal {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kMostAxes = 2;
/// Directions that the linear axes hardly move count as none.
constexpr double kHardlyMoves = 1e-3;

/// Parameters that the rotary axes' errors are made of.
std::vector<int> rotary_parameters(const FitResult& result, const ErrorField& field) {
  std::vector<int> places;
  for (const FunctionGroup& group : result.layout.groups) {
    if (!is_rotary(group.axis)) continue;
    for (int i = 0; i < group.size(); ++i) places.push_back(group.offset + i);
  }
  for (const ParameterBlock& block : result.layout.blocks) {
    if (block.location && is_rotary(block.location->axis)) places.push_back(block.offset);
  }
  for (const EffectColumn& column : field.effects().columns()) {
    if (column.target.kind == TargetKind::Motion && is_rotary(column.target.symbol.axis))
      places.push_back(column.parameter);
  }
  std::ranges::sort(places);
  const auto repeated = std::unique(places.begin(), places.end());
  places.erase(repeated, places.end());
  return places;
}

PoseErrors<double> of_rotary_axes_alone(PoseErrors<double> errors) {
  for (const AxisName axis : kAllAxes) {
    if (is_rotary(axis)) continue;
    errors.motion[index_of(axis)] = {};
    errors.location[index_of(axis)] = {};
  }
  return errors;
}

double nearest_to_zero(const Axis& axis) { return std::clamp(0.0, axis.travel_min, axis.travel_max); }

AxisPosition followed(const KinematicChain& chain, const Machine& machine, const Tool& tool,
                      const Vector3d& point_w, AxisPosition position) {
  Eigen::MatrixXd moves(3, 0);
  std::vector<AxisName> axes;
  for (const AxisName axis : machine.parallel_axes()) position[index_of(axis)] = machine.axis(axis).home;
  const Vector3d here = chain.nominal_point_w(position, tool.offset);
  for (const Axis& axis : machine.axes) {
    if (is_rotary(axis.name) || is_parallel(axis.name)) continue;
    AxisPosition moved = position;
    moved[index_of(axis.name)] += 1.0;
    moves.conservativeResize(Eigen::NoChange, moves.cols() + 1);
    moves.rightCols<1>() = chain.nominal_point_w(moved, tool.offset) - here;
    axes.push_back(axis.name);
  }
  const Eigen::VectorXd steps = least_squares(moves, point_w - here, kHardlyMoves).solution;
  for (std::size_t k = 0; k < axes.size(); ++k)
    position[index_of(axes[k])] += steps[static_cast<Eigen::Index>(k)];
  return position;
}

class RotaryMapMaker {
 public:
  RotaryMapMaker(const FitResult& result, const Tool& tool, const Vector3d& point_w,
                 const Conditions& conditions)
      : machine_(result.machine),
        chain_(result.machine),
        tool_(tool),
        point_w_(point_w),
        field_(result, tool, conditions),
        places_(rotary_parameters(result, field_)),
        covariance_(covariance_of(result, places_)) {}

  AxisPosition pose(const AxisPosition& rotary) const {
    return followed(chain_, machine_, tool_, point_w_, rotary);
  }

  RotaryMapNode at(const AxisPosition& position) const {
    const ToolTwist twist =
        chain_.first_order(position, tool_.offset, of_rotary_axes_alone(field_.joint_errors(position)));
    RotaryMapNode node;
    node.value << twist.displacement_w, twist.rotation_tool_side_w + twist.rotation_workpiece_side_w;
    const PoseErrorRows rows = field_.unheld_rows(position)(Eigen::all, places_);
    const Eigen::Matrix<double, 6, 6> covariance = rows * covariance_ * rows.transpose();
    node.u = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    const Vector3d axis = chain_.nominal_rotation_wt(position).col(2);
    const Vector3d turned = node.value.tail<3>() - axis * axis.dot(node.value.tail<3>());
    node.size = node.value.head<3>().norm();
    node.tool_axis = turned.norm();
    node.u_size = u_along(covariance.topLeftCorner<3, 3>(), node.value.head<3>());
    node.u_tool_axis = u_along(covariance.bottomRightCorner<3, 3>(), turned);
    node.extrapolated = is_beyond(position);
    return node;
  }

 private:
  static double u_along(const Eigen::Matrix3d& covariance, const Vector3d& vector) {
    const double size = vector.norm();
    if (size == 0.0) return std::sqrt(std::max(0.0, covariance.trace() / 3.0));
    return std::sqrt(std::max(0.0, vector.dot(covariance * vector))) / size;
  }

  bool is_beyond(AxisPosition position) const {
    for (const AxisName axis : kAllAxes) {
      if (!is_rotary(axis)) position[index_of(axis)] = field_.measured().held(position)[index_of(axis)];
    }
    return field_.measured().is_beyond(position);
  }

  const Machine& machine_;
  KinematicChain chain_;
  Tool tool_;
  Vector3d point_w_;
  ErrorField field_;
  std::vector<int> places_;
  Eigen::MatrixXd covariance_;
};

}  // namespace

Vector3d middle_point_w(const Machine& machine, const Tool& tool) {
  AxisPosition middle{};
  for (const Axis& axis : machine.axes) {
    if (!is_rotary(axis.name)) middle[index_of(axis.name)] = 0.5 * (axis.travel_min + axis.travel_max);
  }
  return KinematicChain(machine).nominal_point_w(middle, tool.offset);
}

AxisPosition rotary_axes_at_rest(const Machine& machine) {
  AxisPosition rest{};
  for (const Axis& axis : machine.axes) {
    if (is_rotary(axis.name)) rest[index_of(axis.name)] = nearest_to_zero(axis);
  }
  return rest;
}

AxisPosition followed_pose(const Machine& machine, const Tool& tool, const Vector3d& point_w,
                           AxisPosition rotary) {
  return followed(KinematicChain(machine), machine, tool, point_w, rotary);
}

RotaryMap rotary_map(const FitResult& result, const Tool& tool, const Vector3d& point_w,
                     const Conditions& conditions, double largest_step) {
  std::vector<AxisName> axes = identified_rotary_axes(result);
  if (axes.empty())
    throw InputError({}, "no errors of rotary axes were identified",
                     "measure with the rotary axes in several positions");
  if (axes.size() > kMostAxes) axes.resize(kMostAxes);
  RotaryMap map{tool.name, point_w, {}, {}, {}};
  const AxisPosition start = rotary_axes_at_rest(result.machine);
  RotaryGrid grid;
  for (const AxisName axis : axes) grid.axes.push_back(rotary_nodes(result, axis, largest_step));
  const RotaryMapMaker maker(result, tool, point_w, conditions);
  for (AxisPosition position : grid.positions()) {
    for (const Axis& axis : result.machine.axes) {
      const bool varies = std::ranges::find(axes, axis.name) != axes.end();
      if (is_rotary(axis.name) && !varies) position[index_of(axis.name)] = start[index_of(axis.name)];
    }
    map.poses.push_back(maker.pose(position));
    map.nodes.push_back(maker.at(map.poses.back()));
  }
  map.axes = std::move(grid.axes);
  return map;
}

}  // namespace volcal
