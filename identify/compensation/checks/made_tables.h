#pragma once
/// Tables made, read back and judged: the whole job of `volcal tables`.

#include <vector>

#include "volcal/identify/compensation/checks/all_axes_check.h"
#include "volcal/identify/compensation/checks/rotary_check.h"
#include "volcal/identify/compensation/checks/volume_check.h"
#include "volcal/identify/compensation/table_format.h"

namespace volcal {

/// How closely tables follow the ideal compensation unless the user says otherwise, m.
inline constexpr double kDefaultTableTolerance = 0.2e-6;

/// Tables that were made, and what they leave.
struct MadeTables {
  const TableFormat* format = nullptr;
  TableFormatOptions options;  ///< with the step that was chosen
  StepChoice step;
  double tolerance = 0.0;  ///< m; 0 = the step was given or is the format's own
  std::vector<TableFile> files;
  CompensationTables read_back;
  VolumeCheck check;
  std::optional<RotaryCheck> rotary_check;  ///< of a type for rotary axes
  std::optional<AllAxesCheck> all_axes;     ///< of a machine with rotary axes
  std::vector<Finding> effects_left_out;    ///< what was identified and is in none of them, or partly
  /// What else there is to know before they are loaded: rotary axes that were not identified, levers of a
  /// tilted head, positions that are too far apart, tables that leave more than there is without them.
  std::vector<Finding> cautions;
};

/// `options.step` and `options.rotary_step` 0: the largest round steps at which the tables follow the ideal
/// compensation within `tolerance`, m, 0 = kDefaultTableTolerance, as near as choose_step() and
/// choose_rotary_step() come; a format with positions of its own keeps those where no tolerance is given.
/// Throws InputError.
MadeTables make_tables(const TableFormat& format, const FitResult& result, const TableFormatOptions& options,
                       double tolerance = 0.0);

}  // namespace volcal
