#pragma once
/// What a compensation leaves of the errors of rotary axes, over poses of all axes: the machine as it is,
/// with the ideal compensation of the type, and with the tables as written and read back.

#include <cmath>
#include <optional>
#include <vector>

#include "volcal/identify/compensation/compensation_tables.h"
#include "volcal/identify/compensation/five_axis_compensation.h"
#include "volcal/identify/compensation/table_format.h"

namespace volcal {

inline constexpr int kRotaryCheckPoses = 400;

/// Of the functional point, m, no motion of the frame removed; and of the direction of the tool's axis, rad.
struct RotaryLeft {
  double rms = 0.0;  ///< sqrt(mean |e|^2)
  double max = 0.0;
  double axis_rms = 0.0;
};

struct RotaryCheck {
  RotaryLeft before, ideal, exported;
  /// Of the tables from the ideal, both as the mean of the directions: largest displacement of the functional
  /// point, m.
  double deviation = 0.0;
  /// RMS of what the tables leave since they are the mean of the directions of approach, m.
  double without_directions = 0.0;
  /// Standard uncertainty of the errors of rotary axes as identified, and of those that the type corrects,
  /// RMS over the poses (pose_uncertainty.h), m. make_tables() states them.
  double identification_u = 0.0, corrected_u = 0.0;
  /// RMS to be expected on the machine with the tables: what they leave and this uncertainty, m.
  double expected_rms() const { return std::hypot(exported.rms, identification_u); }
};

/// By the exact model with the identified errors of the rotary axes alone, approached from either side as
/// often; what tables of the linear axes' types alone, written and read back likewise, add with the rotary
/// axes at 0 is taken off. Nothing for a type without rotary axes.
std::optional<RotaryCheck> check_rotary_axes(const TableFormat& format, const FitResult& result,
                                             const TableFormatOptions& options,
                                             const CompensationTables& tables);

/// Largest step between positions of rotary axes, rad, at which the tables, read back, follow the ideal
/// compensation within `tolerance`, m: the default (0), or below it 5, 2, 1 or 0.5 degrees; where none does,
/// the one that follows best, or the coarser where it is as good. `options.step` must be chosen.
double choose_rotary_step(const TableFormat& format, const FitResult& result, TableFormatOptions options,
                          double tolerance);

/// What tables add to the commands of X, Y, Z for errors of linear axes, with the rotary axes at 0: without
/// what the ideal compensation of the type's rotary axes adds there, by turning them or, where the tables
/// turn none, by X, Y, Z alone. `tables` must live as long.
DisplacementField linear_part(const FitResult& result, const TableFormatOptions& options,
                              const CompensationTables& tables);

/// What tables do about the errors of rotary axes at one pose.
struct RotaryCorrected {
  Correction correction;              ///< that the tables add for them
  FiveAxisCompensation::Left before;  ///< error of the rotary axes without the tables
  FiveAxisCompensation::Left left;    ///< and with them
};

/// At poses of all axes, as in the check.
std::vector<RotaryCorrected> rotary_corrections(const TableFormat& format, const FitResult& result,
                                                const TableFormatOptions& options,
                                                const CompensationTables& tables,
                                                const std::vector<AxisPosition>& poses);

}  // namespace volcal
