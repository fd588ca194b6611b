#pragma once
/// What tables leave of all identified errors together, over poses of all axes.

#include <cmath>
#include <optional>

#include "volcal/identify/compensation/checks/volume_check.h"
#include "volcal/identify/compensation/compensation_tables.h"
#include "volcal/identify/compensation/table_format.h"

namespace volcal {

inline constexpr int kAllAxesPoses = 400;

/// Of the functional point and of the direction of the tool's axis, two components, rad (ISO/TR 16907:2015,
/// 8.2.6): both after the rigid motion of the workpiece that is best for the functional points.
struct PoseErrorLeft : ErrorLeft {
  double axis_rms = 0.0;
  double axis_max = 0.0;
};

struct AllAxesCheck {
  PoseErrorLeft before, exported;
  /// What L-VOL made with the rotary axes at 0, without any table's step, leaves of the errors of linear axes
  /// alone: where a head is tilted, their angles act by another lever.
  PoseErrorLeft levers;
  /// Standard uncertainty of all errors as identified, RMS over the poses (pose_uncertainty.h), m.
  /// make_tables() states it.
  double identification_u = 0.0;
  /// RMS to be expected on the machine with the tables: what they leave and this uncertainty, m.
  double expected_rms() const { return std::hypot(exported.rms, identification_u); }
};

/// By the exact model with the errors as identified, approached from either side as often, after the best
/// rigid motion of the workpiece. Where tables were active, the new ones replace them. Nothing for a machine
/// without rotary axes.
std::optional<AllAxesCheck> check_all_axes(const FitResult& result, const TableFormatOptions& options,
                                           const CompensationTables& tables);

}  // namespace volcal
