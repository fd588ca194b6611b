#pragma once
/// An ideal compensation of any type as tables of one axis and products of a table and a lever, for
/// controllers that multiply tables. What angular errors do away from the specific lines (L-ANG) is, to first
/// order, the angle of one axis times the distance of another from its line: of every pair of axes the outer
/// one turns and the inner one is the lever.

#include <Eigen/Core>
#include <vector>

#include "volcal/identify/compensation/sampled_tables.h"

namespace volcal {

/// Correction of `output`, m: angle.value(q_a) (q_b - lines_b), a the input of the table, b the lever.
struct LeverProduct {
  AxisName output = AxisName::X;
  AxisName lever = AxisName::Y;
  AxisTable angle;  ///< m/m, by direction where the format tells them apart
};

struct ProductTables {
  std::vector<SampledTable>
      tables;  ///< every input and output of the linear axes once, with zeros if need be
  std::vector<LeverProduct> products;
  AxisPosition lines{};
};

/// At the options' step. Throws InputError where a table would exceed the format's points, and where the
/// compensation is no such sum, as that of superimposed grids may be.
ProductTables sample_product_tables(const TableFormat& format, const FitResult& result,
                                    const TableFormatOptions& options);

}  // namespace volcal
