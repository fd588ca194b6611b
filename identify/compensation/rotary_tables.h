#pragma once
/// Compensations of rotary axes sampled for a format.

#include <vector>

#include "volcal/identify/compensation/five_axis_compensation.h"
#include "volcal/identify/compensation/sampled_tables.h"
#include "volcal/identify/errors/rotary/rotary_grid.h"

namespace volcal {

/// Largest step of a table of one rotary axis unless the user says otherwise, rad: 5 degrees.
inline constexpr double kDefaultRotaryTableStep = 5.0 * 3.14159265358979323846 / 180.0;

/// Largest step of the options, or the default, rad.
double grid_step(const TableFormatOptions& options);
double rotary_table_step(const TableFormatOptions& options);

/// Error of the linear axes at home approached towards +, m, which their tables leave, since they are zero
/// there. Where a table turns the workpiece it does not turn with it: it is a displacement of the table's
/// outermost axis. Zero where there is no such axis or its errors were not identified, and where the type has
/// no tables of linear axes.
Eigen::Vector3d error_at_home_of_table(const FitResult& result, const TableFormatOptions& options);
/// The same where the type has R-POR, which corrects it; otherwise zero.
Eigen::Vector3d displacement_at_home(const FitResult& result, const TableFormatOptions& options);

/// Of all rotary axes at a pose, with displacement_at_home().
JointErrorSource rotary_errors_to_correct(const FitResult& result, const TableFormatOptions& options);

/// Grids of rotary_grids() as compensations hold them, with displacement_at_home().
std::vector<RotaryGrid> rotary_grids_to_correct(const FitResult& result, const TableFormatOptions& options,
                                                const RotaryShares& shares = {});

/// What a type corrects of twists by the linear axes. Throws InputError for R-RAX without R-ANG and the other
/// way round.
RotaryShares twist_shares(const TableFormat& format, CompensationType type);

/// A displacement of the functional point against the workpiece, m, machine coordinates with the rotary axes
/// at 0, as the location error of the outermost axis that turns the workpiece; nothing where there is none.
void add_displacement_of_table(const Structure& structure, const Eigen::Vector3d& displacement,
                               PoseErrors<double>& errors);

/// R-POS: what each identified rotary axis adds to its own command, rad, at equal steps; `beyond` is Repeat
/// where one turn is written. A format that tells no directions apart gets the mean in both columns.
std::vector<SampledTable> sample_rotary_positioning(const TableFormat& format, const FitResult& result,
                                                    const TableFormatOptions& options);

/// One turn from 0, as a modulo axis counts it, its end as its beginning; a table that does not repeat as it
/// is.
AxisTable turn_from_zero(const AxisTable& table);
/// Whether positions make a turn.
bool make_a_turn(const std::vector<double>& positions);

}  // namespace volcal
