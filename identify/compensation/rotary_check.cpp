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

/// The machine with the errors of its rotary axes alone, and what tables add to its commands for them.
class RotaryJudgement {
 public:
  RotaryJudgement(const TableFormat& format, const FitResult& result, const TableFormatOptions& options,
                  const CompensationTables& tables)
      : ideal_(result.machine, settings_of(result, options), errors_of(result, options)),
        of_linear_(sampled_compensation(format, result, options)),
        has_linear_(!options.type.linear().empty()),
        tables_(tables) {}

  const FiveAxisCompensation& ideal() const { return ideal_; }
  Correction by_tables(const AxisPosition& pose) const {
    Correction correction = tables_.correction(pose, {});
    if (has_linear_) correction.linear -= of_linear_.correction(without_rotary_axes(pose), {});
    return correction;
  }

 private:
  static FiveAxisSettings settings_of(const FitResult& result, const TableFormatOptions& options) {
    FiveAxisSettings settings;
    settings.type = options.type.rotary();
    settings.tool_offset = tool_of(result.machine, options).offset;
    return settings;
  }
  static JointErrorSource errors_of(const FitResult& result, const TableFormatOptions& options) {
    return of_rotary_axes(
        joint_errors(result, tool_of(result.machine, options), conditions_of(result, options)));
  }

  FiveAxisCompensation ideal_;
  Compensation of_linear_;
  bool has_linear_;
  const CompensationTables& tables_;
};

}  // namespace

std::optional<RotaryCheck> check_rotary_axes(const TableFormat& format, const FitResult& result,
                                             const TableFormatOptions& options,
                                             const CompensationTables& tables) {
  if (options.type.rotary().empty()) return std::nullopt;
  const RotaryJudgement judgement(format, result, options, tables);
  const FiveAxisCompensation& ideal = judgement.ideal();
  const std::vector<AxisPosition> poses = poses_of_all_axes(result.machine, kRotaryCheckPoses);
  return RotaryCheck{
      left_under(ideal, poses, [](const AxisPosition&) { return Correction{}; }),
      left_under(ideal, poses, [&](const AxisPosition& pose) { return ideal.correction(pose); }),
      left_under(ideal, poses, [&](const AxisPosition& pose) { return judgement.by_tables(pose); })};
}

std::vector<RotaryCorrected> rotary_corrections(const TableFormat& format, const FitResult& result,
                                                const TableFormatOptions& options,
                                                const CompensationTables& tables,
                                                const std::vector<AxisPosition>& poses) {
  const RotaryJudgement judgement(format, result, options, tables);
  std::vector<RotaryCorrected> corrected;
  for (const AxisPosition& pose : poses) {
    const Correction correction = judgement.by_tables(pose);
    corrected.push_back(
        {correction, judgement.ideal().left_by({}, pose), judgement.ideal().left_by(correction, pose)});
  }
  return corrected;
}

}  // namespace volcal
