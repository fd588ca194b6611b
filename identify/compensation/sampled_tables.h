#pragma once
/// An ideal compensation sampled for a format: tables of one axis each, or a grid.

#include <vector>

#include "volcal/identify/compensation/table_format.h"

namespace volcal {

/// What the position of `table.input` adds to the command of `output`.
struct SampledTable {
  AxisName output = AxisName::X;
  AxisTable table;
};

/// A separable type (CompensationType::is_separable) as tables at the options' step, input axes X Y Z, each
/// with the outputs that the type moves. A format that tells no directions apart gets the mean in both
/// columns. Throws InputError where a table would exceed the format's points.
std::vector<SampledTable> sample_axis_tables(const TableFormat& format, const FitResult& result,
                                             const TableFormatOptions& options);

/// Any type on a grid at the options' step.
CorrectionGrid sample_grid(const TableFormat& format, const FitResult& result,
                           const TableFormatOptions& options);

/// Nodes of a grid written row by row, Z fastest. `points`: X, Y, Z of each row; `places`: where it stands.
/// Throws InputError when the rows are no complete grid in this order.
std::array<std::vector<double>, 3> grid_nodes(const std::vector<std::array<double, 3>>& points,
                                              const std::vector<SourcePlace>& places);

/// 0.0 in place of -0.0, which would be written with its sign.
inline double without_negative_zero(double value) { return value + 0.0; }

}  // namespace volcal
