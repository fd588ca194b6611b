#include "volcal/identify/compensation/checks/rotary_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "volcal/identify/compensation/five_axis_compensation.h"
#include "volcal/identify/compensation/rotary_tables.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

using LeftAtPoses = std::vector<FiveAxisCompensation::Left>;

template <class CorrectionAt>
LeftAtPoses left_under(const FiveAxisCompensation& ideal, const std::vector<ApproachedPose>& poses,
                       const CorrectionAt& correction_at) {
  LeftAtPoses left;
  for (const ApproachedPose& at : poses)
    left.push_back(ideal.left_by(correction_at(at), at.position, at.direction));
  return left;
}

RotaryLeft figures_of(const LeftAtPoses& errors) {
  RotaryLeft left;
  for (const FiveAxisCompensation::Left& error : errors) {
    const double point = error.displacement_w.norm();
    left.rms += point * point / static_cast<double>(errors.size());
    left.max = std::max(left.max, point);
    left.axis_rms += error.axis * error.axis / static_cast<double>(errors.size());
  }
  left.rms = std::sqrt(left.rms);
  left.axis_rms = std::sqrt(left.axis_rms);
  return left;
}

FiveAxisCompensation ideal_of_rotary_axes(const FitResult& result, const TableFormatOptions& options,
                                          bool turns_axes = true) {
  const Tool& tool = tool_of(result.machine, options);
  FiveAxisSettings settings;
  settings.type = options.type.rotary();
  settings.tool_offset = tool.offset;
  settings.turns_axes = turns_axes;
  return {result.machine, settings, rotary_errors_to_correct(result, options)};
}

using LinearTables = std::optional<CompensationTables>;

/// Of the types of linear axes alone, read back; none where there is no such type.
LinearTables tables_of_linear_axes(const TableFormat& format, const FitResult& result,
                                   TableFormatOptions options) {
  options.type = options.type.linear();
  if (options.type.empty()) return std::nullopt;
  return format.read(write_tables(format, result, options));
}

/// The machine with the errors of its rotary axes alone, and what tables add to its commands for them.
class RotaryJudgement {
 public:
  RotaryJudgement(const FitResult& result, const TableFormatOptions& options,
                  const CompensationTables& tables, const LinearTables& of_linear)
      : ideal_(ideal_of_rotary_axes(result, options)), of_linear_(of_linear), tables_(tables) {}

  const FiveAxisCompensation& ideal() const { return ideal_; }
  Correction by_tables(const ApproachedPose& at) const {
    Correction correction = tables_.correction(at.position, at.direction);
    if (of_linear_)
      correction.linear -= of_linear_->correction(without_rotary_axes(at.position), at.direction).linear;
    return correction;
  }
  Correction by_ideal(const ApproachedPose& at) const { return ideal_.correction(at.position, at.direction); }

 private:
  FiveAxisCompensation ideal_;
  const LinearTables& of_linear_;
  const CompensationTables& tables_;
};

RotaryCheck checked(const FitResult& result, const RotaryJudgement& judgement) {
  const FiveAxisCompensation& ideal = judgement.ideal();
  const auto none = [](const ApproachedPose&) { return Correction{}; };
  const auto by_ideal = [&](const ApproachedPose& at) { return judgement.by_ideal(at); };
  const auto by_tables = [&](const ApproachedPose& at) { return judgement.by_tables(at); };
  std::vector<ApproachedPose> poses = approached_poses_of_all_axes(result.machine, kRotaryCheckPoses);
  RotaryCheck check{figures_of(left_under(ideal, poses, none)),
                    figures_of(left_under(ideal, poses, by_ideal)),
                    figures_of(left_under(ideal, poses, by_tables))};
  for (ApproachedPose& pose : poses) pose.direction = {};
  const LeftAtPoses mean_ideal = left_under(ideal, poses, by_ideal);
  const LeftAtPoses mean_tables = left_under(ideal, poses, by_tables);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Vector3d between_w = mean_tables[i].displacement_w - mean_ideal[i].displacement_w;
    check.deviation = std::max(check.deviation, between_w.norm());
  }
  const double left = check.exported.rms, of_mean = figures_of(mean_tables).rms;
  check.without_directions = std::sqrt(std::max(0.0, left * left - of_mean * of_mean));
  return check;
}

}  // namespace

DisplacementField linear_part(const FitResult& result, const TableFormatOptions& options,
                              const CompensationTables& tables) {
  if (options.type.rotary().empty())
    return [&tables](const AxisPosition& position, const ApproachDirection& direction) {
      return tables.correction(position, direction).linear;
    };
  return [&tables, turning = ideal_of_rotary_axes(result, options),
          moving = ideal_of_rotary_axes(result, options, false)](const AxisPosition& position,
                                                                 const ApproachDirection& direction) {
    const Correction correction = tables.correction(position, direction);
    // A control that turns no axis undoes with X, Y and Z what R-POS corrects.
    const FiveAxisCompensation& ideal = correction.rotary.isZero(0.0) ? moving : turning;
    return Eigen::Vector3d(correction.linear - ideal.correction(position).linear);
  };
}

std::optional<RotaryCheck> check_rotary_axes(const TableFormat& format, const FitResult& result,
                                             const TableFormatOptions& options,
                                             const CompensationTables& tables) {
  if (options.type.rotary().empty()) return std::nullopt;
  const LinearTables of_linear = tables_of_linear_axes(format, result, options);
  return checked(result, {result, options, tables, of_linear});
}

double choose_rotary_step(const TableFormat& format, const FitResult& result, TableFormatOptions options,
                          double tolerance) {
  constexpr std::array<double, 5> kSteps = {0.0, 5.0, 2.0, 1.0, 0.5};  // deg
  constexpr double kAsGood = 0.95;
  if (options.type.rotary().empty()) return options.rotary_step;
  const LinearTables of_linear = tables_of_linear_axes(format, result, options);
  double best = options.rotary_step, least = std::numeric_limits<double>::infinity();
  for (const double step : kSteps) {
    options.rotary_step = step * kRadianPerDegree;
    try {
      const std::vector<TableFile> files = write_tables(format, result, options);
      if (bytes_of(files) > kMostTableBytes) break;
      const CompensationTables tables = format.read(files);
      const double deviation = checked(result, {result, options, tables, of_linear}).deviation;
      if (deviation < kAsGood * least) {
        best = options.rotary_step;
        least = deviation;
      }
    } catch (const InputError&) {  // more points than the controller has
      break;
    }
    if (least <= tolerance) break;
  }
  return best;
}

std::vector<RotaryCorrected> rotary_corrections(const TableFormat& format, const FitResult& result,
                                                const TableFormatOptions& options,
                                                const CompensationTables& tables,
                                                const std::vector<AxisPosition>& poses) {
  const LinearTables of_linear = tables_of_linear_axes(format, result, options);
  const RotaryJudgement judgement(result, options, tables, of_linear);
  std::vector<RotaryCorrected> corrected;
  for (const AxisPosition& pose : poses) {
    const Correction correction = judgement.by_tables({pose});
    corrected.push_back(
        {correction, judgement.ideal().left_by({}, pose), judgement.ideal().left_by(correction, pose)});
  }
  return corrected;
}

}  // namespace volcal
