#pragma once
/// The spatial grid of rotary axes (ISO/TR 16907:2015, 9.3.2, Table 3) as a CSV file, and how a control
/// evaluates it. Lines "# key = value" state what 9.1 asks for: body, reference point, axes, errors or
/// compensations, what happens beyond a turn, whether rotations of the axes about themselves are in it. Then
/// a row per node: positions in deg, ex ey ez (dx dy dz of compensations) in um, ea eb ec (da db dc) in urad.

#include <span>
#include <string>
#include <vector>

#include "volcal/identify/compensation/compensation_tables.h"
#include "volcal/identify/compensation/csv_tables.h"
#include "volcal/identify/errors/rotary/rotary_grid.h"

namespace volcal {

/// "rotary_error_grid_table.csv", "rotary_compensation_grid_tool.csv".
std::string rotary_grid_file_name(TurnedBody body, TableContent content);

/// `own_rotations`: whether the twists hold rotations of the axes about themselves.
std::string rotary_grid_csv(const RotaryGrid& grid, TableContent content, bool own_rotations);
/// Errors, whatever the file holds. Throws InputError with file, line and remedy.
RotaryGrid read_rotary_grid(const TableFile& file, TableContent content);
/// The grids among the files, of table and tool.
std::vector<RotaryGrid> read_rotary_grids(std::span<const TableFile> files, TableContent content);

/// Linear between nodes, positions modulo a turn where the grid says so, otherwise held beyond the ends.
PoseErrorVector twist_at(const RotaryGrid& grid, const AxisPosition& position);

/// Moves of the linear axes that undo the displacements of all twists at the functional point of a tool.
CorrectionTerm rotary_grid_term(std::vector<RotaryGrid> grids, const Machine& machine,
                                const Eigen::Vector3d& tool_offset);

}  // namespace volcal
