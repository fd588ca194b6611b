#include "volcal/identify/compensation/rotary_check.h"

#include <algorithm>
#include <cmath>

#include "volcal/identify/compensation/five_axis_compensation.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"

namespace volcal {
namespace {

JointErrorSource of_rotary_axes(const JointErrorSource& all) {
  return [all](const AxisPosition& position, const ApproachDirection& direction) {
    PoseErrors<double> errors = all(position, direction);
    for (const AxisName axis : kAllAxes) {
      if (is_rotary(axis)) continue;
      errors.motion[index_of(axis)] = {};
      errors.location[index_of(axis)] = {};
    }
    return errors;
  };
}

template <class CorrectionAt>
RotaryLeft left_under(const FiveAxisCompensation& ideal, const std::vector<AxisPosition>& poses,
                      const CorrectionAt& correction_at) {
  RotaryLeft left;
  for (const AxisPosition& pose : poses) {
    const FiveAxisCompensation::Left error = ideal.left_by(correction_at(pose), pose);
    const double point = error.displacement_w.norm();
    left.rms += point * point / static_cast<double>(poses.size());
    left.max = std::max(left.max, point);
    left.axis_rms += error.axis * error.axis / static_cast<double>(poses.size());
  }
  left.rms = std::sqrt(left.rms);
  left.axis_rms = std::sqrt(left.axis_rms);
  return left;
}

}  // namespace

std::optional<RotaryCheck> check_rotary_axes(const TableFormat& format, const FitResult& result,
                                             const TableFormatOptions& options,
                                             const CompensationTables& tables) {
  if (options.type.rotary().empty()) return std::nullopt;
  const Tool& tool = tool_of(result.machine, options);
  FiveAxisSettings settings;
  settings.type = options.type.rotary();
  settings.tool_offset = tool.offset;
  const FiveAxisCompensation ideal(
      result.machine, settings, of_rotary_axes(joint_errors(result, tool, conditions_of(result, options))));
  const Compensation of_linear = sampled_compensation(format, result, options);
  const auto by_tables = [&](const AxisPosition& pose) {
    Correction correction = tables.correction(pose, {});
    if (!options.type.linear().empty())
      correction.linear -= of_linear.correction(without_rotary_axes(pose), {});
    return correction;
  };
  const std::vector<AxisPosition> poses = poses_of_all_axes(result.machine, kRotaryCheckPoses);
  return RotaryCheck{
      left_under(ideal, poses, [](const AxisPosition&) { return Correction{}; }),
      left_under(ideal, poses, [&](const AxisPosition& pose) { return ideal.correction(pose); }),
      left_under(ideal, poses, by_tables)};
}

}  // namespace volcal
