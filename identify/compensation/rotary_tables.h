#pragma once
/// Compensations of rotary axes sampled for a format.

#include <vector>

#include "volcal/identify/compensation/sampled_tables.h"

namespace volcal {

/// Largest step of a table of one rotary axis unless the user says otherwise, rad: 5 degrees.
inline constexpr double kDefaultRotaryTableStep = 5.0 * 3.14159265358979323846 / 180.0;

/// Largest step of the options, or the default, rad.
double grid_step(const TableFormatOptions& options);
double rotary_table_step(const TableFormatOptions& options);

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
