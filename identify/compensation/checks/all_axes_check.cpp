#include "volcal/identify/compensation/checks/all_axes_check.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "volcal/identify/compensation/five_axis_compensation.h"
#include "volcal/identify/compensation/joint_error_shares.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/errors/volume/volumetric.h"

namespace volcal {
namespace {

/// Directions of the tool's axis, as they should be and as they are.
struct AxisAtPose {
  Eigen::Vector3d nominal_w, actual_w;
};

/// A workpiece that turns by `rotation` takes the direction along that the tool should have.
void add_axis_figures(const std::vector<AxisAtPose>& axes, const Eigen::Vector3d& rotation,
                      PoseErrorLeft& left) {
  double squares = 0.0;
  for (const AxisAtPose& axis : axes) {
    const Eigen::Vector3d turned_w = axis.nominal_w + rotation.cross(axis.nominal_w);
    const double angle = std::atan2(axis.actual_w.cross(turned_w).norm(), axis.actual_w.dot(turned_w));
    squares += angle * angle;
    left.axis_max = std::max(left.axis_max, angle);
  }
  left.axis_rms = std::sqrt(squares / static_cast<double>(axes.size()));
}

template <class CorrectionAt>
PoseErrorLeft left_of(const FiveAxisCompensation& machine, const std::vector<ApproachedPose>& poses,
                      const CorrectionAt& correction_at) {
  std::vector<Eigen::Vector3d> places, errors;
  std::vector<AxisAtPose> axes;
  for (const auto& [position, direction] : poses) {
    const auto left = machine.left_by(correction_at(position, direction), position, direction);
    places.push_back(machine.nominal_point_w(position));
    errors.push_back(left.displacement_w);
    axes.push_back({machine.nominal_axis_w(position), left.axis_w});
  }
  const RigidMotion motion = best_rigid_motion(places, errors);
  for (std::size_t i = 0; i < places.size(); ++i) errors[i] -= motion.at(places[i]);
  const VolumetricFigures figures = volumetric_figures(errors);
  PoseErrorLeft left{{figures.rms, figures.max}};
  add_axis_figures(axes, motion.rotation, left);
  return left;
}

}  // namespace

std::optional<AllAxesCheck> check_all_axes(const FitResult& result, const TableFormatOptions& options,
                                           const CompensationTables& tables) {
  const Machine& machine = result.machine;
  if (std::ranges::none_of(machine.axes, [](const Axis& axis) { return is_rotary(axis.name); }))
    return std::nullopt;
  const Tool& tool = tool_of(machine, options);
  FiveAxisSettings settings;
  settings.tool_offset = tool.offset;
  const JointErrorSource all = joint_and_tool_errors(result, tool, conditions_of(result, options));
  const FiveAxisCompensation of_all(machine, settings, all);
  const FiveAxisCompensation of_linear(machine, settings, of_linear_axes(all));
  TableFormatOptions whole = options;
  whole.type = CompensationType::volumetric();
  whole.active.reset();
  const Compensation ideal = ideal_compensation(result, whole);
  const std::vector<ApproachedPose> poses = approached_poses_of_all_axes(machine, kAllAxesPoses);
  const auto none = [](const AxisPosition&, const ApproachDirection&) { return Correction{}; };
  const auto by_tables = [&](const AxisPosition& pose, const ApproachDirection& from) {
    Correction correction = tables.correction(pose, from);
    if (options.active) correction.linear -= options.active->correction(pose, from).linear;
    return correction;
  };
  const auto at_rest = [&](const AxisPosition& pose, const ApproachDirection& from) {
    return Correction{ideal.correction(without_rotary_axes(pose), from)};
  };
  return AllAxesCheck{left_of(of_all, poses, none), left_of(of_all, poses, by_tables),
                      left_of(of_linear, poses, at_rest)};
}

}  // namespace volcal
