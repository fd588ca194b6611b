#pragma once
/// What a compensation leaves in the volume: the machine as it is, with the ideal compensation of the type,
/// and with the tables as written and read back by the rules of the controller.

#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/compensation/compensation.h"
#include "volcal/identify/compensation/compensation_tables.h"
#include "volcal/identify/compensation/table_format.h"
#include "volcal/identify/errors/volume/volumetric.h"

namespace volcal {

/// Errors of the functional point, m, after their best rigid motion, which a frame's alignment takes up.
struct ErrorLeft {
  double rms = 0.0;  ///< sqrt(mean |e|^2) over the volume
  double max = 0.0;  ///< at these places and at the ends of travel
};

struct PartLeft {
  CompensationPart part = CompensationPart::Positioning;
  ErrorLeft before;
  ErrorLeft exported;
};

/// Of a machine with parallel axes U, V, W: the volume with each of them at home and at both ends of its
/// travel, in all combinations.
struct ParallelLeft {
  std::vector<Axis> axes;
  ErrorLeft before;
  ErrorLeft exported;
};

/// Components along which no linear axis moves.
struct FixedLeft {
  std::vector<AxisName> axes;  ///< X, Y, Z that the machine lacks
  ErrorLeft error;             ///< with every other component corrected

  std::string axes_text() const;  ///< "X and Y"
};

/// Parallel axes U, V, W are at home, but for `over_parallel`.
struct VolumeCheck {
  int places = 0;  ///< of the volume, each approached from both sides of every axis
  ErrorLeft before;
  ErrorLeft ideal;     ///< ideal compensation of the type
  ErrorLeft exported;  ///< the tables
  std::vector<PartLeft> parts;
  std::optional<FixedLeft> fixed;  ///< none where axes move along X, Y and Z
  /// Standard uncertainty of the errors as identified, RMS over the volume (volume_uncertainty.h), m.
  double identification_u = 0.0;
  /// RMS to be expected of the machine with the tables: what they leave of the identified errors, and the
  /// uncertainty of these, m.
  double expected_rms() const;
  /// The tables at the ends of the temperatures, times and feeds that the campaign recorded and the errors
  /// depend on; none where they depend on none.
  std::optional<ErrorLeft> over_conditions;
  std::optional<ParallelLeft> over_parallel;  ///< none where the machine has no parallel axis
};

/// Figures of a field at these points: the rigid motion is that of the points inside.
ErrorLeft error_left(const Machine& machine, const std::vector<VolumePoint>& points,
                     const DisplacementField& errors);

/// Errors as identified (error_field.h) in the volume of the options' tool. Where tables were active,
/// `before` is the machine with them, as it was measured, and the new ones replace them.
VolumeCheck check_in_volume(const FitResult& result, const TableFormatOptions& options,
                            const CompensationTables& tables);

/// Step of a table and how far its reader then is from the ideal compensation.
struct StepChoice {
  double step = 0.0;       ///< m
  double deviation = 0.0;  ///< largest difference of a component in the volume, m
  bool reached = false;    ///< deviation within the tolerance
  std::string refusal;     ///< why a finer step was not taken; empty: none was refused
};

/// Largest difference of a component between tables, read back, and what their format samples of the ideal
/// compensation, in the volume, m.
double deviation_of(const TableFormat& format, const FitResult& result, const TableFormatOptions& options,
                    const CompensationTables& tables);

/// The largest step of 1, 2 or 5 x 10^n mm whose tables, read back, follow the ideal compensation, of a
/// format without coupled axes the nearest that a rigid body has, within `tolerance` (m) plus half the
/// format's resolution, which rounding takes; where the controller's limits forbid that, the best one that
/// they allow. A format that tells no directions apart is judged by their mean. Throws InputError when no
/// step is allowed.
StepChoice choose_step(const TableFormat& format, const FitResult& result, TableFormatOptions options,
                       double tolerance);

}  // namespace volcal
