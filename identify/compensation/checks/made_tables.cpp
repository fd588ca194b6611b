#include "volcal/identify/compensation/checks/made_tables.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "volcal/identify/compensation/checks/pose_uncertainty.h"
#include "volcal/identify/compensation/rotary_tables.h"
#include "volcal/identify/errors/rotary/rotary_axes.h"
#include "volcal/identify/text/text_file.h"
#include "volcal/model/description/errors.h"
#include "volcal/model/description/finding_codes.h"
#include "volcal/model/description/units.h"

namespace volcal {
namespace {

constexpr double kNotableLever = 0.1e-6;      // m
constexpr double kNotableAtHome = 0.1e-6;     // m
constexpr double kNotableReversal = 0.1e-6;   // m
constexpr double kNotableIncrease = 0.05e-6;  // m
constexpr double kCoarseStep = 3.0;           // tolerances

/// What was identified and is in none of these tables, or partly.
std::vector<Finding> left_out_by(CompensationType type, const FitResult& result) {
  std::vector<Finding> findings;
  for (const Finding& finding : errors_in_no_table(result, identified_rotary_axes(result))) {
    const bool of_rotary = finding.code == FindingCode::RotaryErrorsInNoTable;
    if (!of_rotary || type.rotary().empty()) {
      findings.push_back(finding);
    } else if (!type.contains(CompensationType::rotary_volumetric())) {
      findings.push_back({FindingCode::RotaryErrorsPartlyInTables,
                          {{"axis", finding.text("axis")}, {"type", type.rotary().name()}}});
    }
  }
  return findings;
}

FindingNumber in_micrometres(double metres) { return {metres, "um", kMetrePerMicrometre}; }

void report_unknown_axes(const FitResult& result, std::vector<Finding>& cautions) {
  const std::vector<AxisName> identified = identified_rotary_axes(result);
  for (const Axis& axis : result.machine.axes) {
    if (is_rotary(axis.name) && std::ranges::find(identified, axis.name) == identified.end())
      cautions.push_back(
          {FindingCode::RotaryErrorsUnknownToTables,
           {{"axis", std::string(1, letter_of(axis.name))},
            {"position", FindingNumber{reference_of(result, axis.name), "deg", kRadianPerDegree}}}});
  }
}

void report_levers(const Machine& machine, MadeTables& made) {
  if (!made.all_axes || made.options.type.linear().empty() || made.all_axes->levers.rms < kNotableLever)
    return;
  std::string head;
  for (const Joint& joint : machine.structure.joints) {
    if (!joint.workpiece_side && is_rotary(joint.axis)) head += letter_of(joint.axis);
  }
  made.cautions.push_back({FindingCode::LeversOfTiltedHead,
                           {{"axes", head},
                            {"rms", in_micrometres(made.all_axes->levers.rms)},
                            {"max", in_micrometres(made.all_axes->levers.max)}}});
}

/// Along the line of a table's only axis nothing turns.
void report_error_at_home(const FitResult& result, MadeTables& made) {
  if (made.options.type.has(CompensationPart::RotaryLocation)) return;
  Eigen::Vector3d turning = error_at_home_of_table(result, made.options);
  std::vector<AxisName> tables = result.machine.rotary_axes();
  std::erase_if(tables, [&](AxisName axis) { return !result.machine.structure.is_on_workpiece_side(axis); });
  if (tables.size() == 1) turning[direction_of(tables.front())] = 0.0;
  if (turning.norm() < kNotableAtHome) return;
  std::string letters;
  for (const AxisName axis : tables) letters += letter_of(axis);
  made.cautions.push_back(
      {FindingCode::ErrorAtHomeTurns, {{"axes", letters}, {"error", in_micrometres(turning.norm())}}});
}

/// Positions that were not chosen by a tolerance.
void report_step(const FitResult& result, MadeTables& made) {
  const CompensationLimits& limits = made.format->limits;
  if (made.tolerance > 0.0 || !limits.sampled || made.options.type.linear().empty()) return;
  const double off = deviation_of(*made.format, result, made.options, made.read_back);
  if (off > kCoarseStep * kDefaultTableTolerance + 0.5 * limits.resolution)
    made.cautions.push_back({FindingCode::TablesOffIdeal,
                             {{"off", in_micrometres(off)}, {"positions", made.format->positions_of_own}}});
}

void report_rotary_step(double tolerance, MadeTables& made) {
  if (!made.rotary_check || made.rotary_check->deviation <= kCoarseStep * tolerance) return;
  made.cautions.push_back({FindingCode::RotaryTablesOffIdeal,
                           {{"off", in_micrometres(made.rotary_check->deviation)},
                            {"constants", made.options.type.rotary() == CompensationPart::RotaryLocation}}});
}

void report_rotary_directions(MadeTables& made) {
  if (!made.rotary_check || made.rotary_check->without_directions < kNotableReversal) return;
  made.cautions.push_back({FindingCode::RotaryTablesWithoutDirections,
                           {{"rms", in_micrometres(made.rotary_check->without_directions)}}});
}

enum class FinerBy { Nothing, Step, StepOrPositions, RotaryStep };

FinerBy finer_linear_tables(const MadeTables& made) {
  if (!made.format->limits.sampled) return FinerBy::Nothing;
  return made.format->positions_of_own ? FinerBy::StepOrPositions : FinerBy::Step;
}

FinerBy finer_rotary_tables(const MadeTables& made) {
  const bool constants = made.options.type.rotary() == CompensationPart::RotaryLocation;
  return constants ? FinerBy::Nothing : FinerBy::RotaryStep;
}

/// Positions that are further apart than the errors change can add to them.
void report_more_than_none(MadeTables& made) {
  const auto report = [&made](double without, double with, FinerBy finer) {
    if (with <= without + kNotableIncrease) return;
    made.cautions.push_back({FindingCode::TablesLeaveMore,
                             {{"without", in_micrometres(without)},
                              {"with", in_micrometres(with)},
                              {"step", finer == FinerBy::Step || finer == FinerBy::StepOrPositions},
                              {"positions", finer == FinerBy::StepOrPositions},
                              {"rotary_step", finer == FinerBy::RotaryStep}}});
  };
  report(made.check.before.rms, made.check.exported.rms, finer_linear_tables(made));
  if (made.rotary_check)
    report(made.rotary_check->before.rms, made.rotary_check->exported.rms, finer_rotary_tables(made));
}

void add_uncertainty(const FitResult& result, MadeTables& made) {
  if (!made.all_axes) return;
  const PoseUncertainty u =
      pose_uncertainty(result, made.options, approached_poses_of_all_axes(result.machine, kAllAxesPoses));
  made.all_axes->identification_u = u.all;
  if (!made.rotary_check) return;
  made.rotary_check->identification_u = u.rotary;
  made.rotary_check->corrected_u = u.corrected;
}

/// Corrections that are less certain than the errors are large.
void report_uncertain_rotary(MadeTables& made) {
  if (!made.rotary_check) return;
  const RotaryCheck& check = *made.rotary_check;
  const double expected = std::hypot(check.exported.rms, check.corrected_u);
  if (expected <= check.before.rms + kNotableIncrease) return;
  made.cautions.push_back(
      {FindingCode::RotaryTablesMayWorsen,
       {{"expected", in_micrometres(expected)}, {"before", in_micrometres(check.before.rms)}}});
}

/// 0 = the default.
void check_tolerance(double tolerance) {
  if (!std::isfinite(tolerance) || tolerance < 0.0)
    throw InputError(
        {}, setting("tolerance") + " " + number_text(tolerance / kMetrePerMicrometre) + " is out of range",
        "give a positive number of um");
}

}  // namespace

MadeTables make_tables(const TableFormat& format, const FitResult& result, const TableFormatOptions& options,
                       double tolerance) {
  MadeTables made;
  made.format = &format;
  made.options = options;
  check_tolerance(tolerance);
  check_table_options(format, result, made.options);
  const bool own_positions = format.positions_of_own && tolerance == 0.0;
  const double wanted = tolerance > 0.0 ? tolerance : kDefaultTableTolerance;
  if (options.step == 0.0 && !own_positions) {
    made.tolerance = wanted;
    made.step = choose_step(format, result, made.options, made.tolerance);
    made.options.step = made.step.step;
  }
  if (format.step_of != nullptr) made.options.step = format.step_of(made.options);
  if (made.options.rotary_step == 0.0 && !own_positions)
    made.options.rotary_step = choose_rotary_step(format, result, made.options, wanted);
  made.files = write_tables(format, result, made.options);
  made.read_back = format.read(made.files);
  made.check = check_in_volume(result, made.options, made.read_back);
  made.rotary_check = check_rotary_axes(format, result, made.options, made.read_back);
  made.all_axes = check_all_axes(result, made.options, made.read_back);
  add_uncertainty(result, made);
  made.effects_left_out = left_out_by(made.options.type, result);
  report_unknown_axes(result, made.cautions);
  report_levers(result.machine, made);
  report_error_at_home(result, made);
  report_step(result, made);
  report_rotary_step(wanted, made);
  report_rotary_directions(made);
  report_more_than_none(made);
  report_uncertain_rotary(made);
  return made;
}

}  // namespace volcal
