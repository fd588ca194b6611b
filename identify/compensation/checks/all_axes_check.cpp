#include "volcal/identify/compensation/checks/all_axes_check.h"

#include <algorithm>
#include <vector>

#include "volcal/identify/compensation/five_axis_compensation.h"
#include "volcal/identify/compensation/joint_error_shares.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/errors/volume/volumetric.h"

namespace volcal {
namespace {

template <class CorrectionAt>
ErrorLeft left_of(const FiveAxisCompensation& machine, const std::vector<ApproachedPose>& poses,
                  const CorrectionAt& correction_at) {
  std::vector<Eigen::Vector3d> places, errors;
  for (const auto& [position, direction] : poses) {
    places.push_back(machine.nominal_point_w(position));
    errors.push_back(machine.left_by(correction_at(position, direction), position, direction).displacement_w);
  }
  const VolumetricFigures figures = volumetric_figures(without_rigid_motion(places, errors));
  return {figures.rms, figures.max};
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
  const JointErrorSource all = joint_errors(result, tool, conditions_of(result, options));
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
